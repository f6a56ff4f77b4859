"""Monitors: a model, joined with the configuration that connects it to a robot."""
