"""Models of a robot, and what they add to a configuration."""
