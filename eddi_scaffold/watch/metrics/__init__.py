"""The view as numbers for other tools (OpenMetrics)."""
