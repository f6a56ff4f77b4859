"""Deployments: several monitors, wired by topics, on one platform."""
