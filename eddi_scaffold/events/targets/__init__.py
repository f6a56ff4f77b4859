"""Standalone monitors from the intermediate form: one printer per language."""
