"""Drafts of configurations: which topics of a robot may fill the inputs of a model."""
