"""Readers of the indentation dialects of MROS."""
