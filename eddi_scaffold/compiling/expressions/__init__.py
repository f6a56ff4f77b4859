"""Conditions over messages and time as straight-line Python: a line for each operation."""
