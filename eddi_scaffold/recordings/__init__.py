"""Recordings played to a monitor in this process, as its node would receive them."""
