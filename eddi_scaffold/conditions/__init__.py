"""Conditional events (SESAME D7.2 section 3.5): a language, its checks, and its targets."""
