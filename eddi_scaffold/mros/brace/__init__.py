"""Readers of the brace dialects of MROS."""
