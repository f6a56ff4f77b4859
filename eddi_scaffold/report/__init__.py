"""One report of what is known of hazards, guarantees and their monitors, in several formats."""
