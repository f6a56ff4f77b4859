"""Deployments: several monitors, wired by topics, on one platform or on several robots."""
