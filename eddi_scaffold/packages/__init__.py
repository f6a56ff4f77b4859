"""Packages on disk: rendered from answers, brought up to date, traced; hand edits stay."""
