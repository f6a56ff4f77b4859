"""Conditions over messages and time: what inputs and the kind ``event`` evaluate."""
