"""Compiled monitors as small programs, which back ends print: Python, and C99 for use by itself."""
