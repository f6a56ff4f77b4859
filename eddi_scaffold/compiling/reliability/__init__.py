"""Reliability models: chains and fault trees as sums, what is large as tables."""
