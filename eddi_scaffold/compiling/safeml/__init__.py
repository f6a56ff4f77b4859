"""SafeML monitors: only constants are compiled."""
