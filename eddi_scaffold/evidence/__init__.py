"""What kinds share to show that a monitor is its model."""
