"""Bayesian networks: the order of all operations is settled here, and a step is written out."""
