"""``deployment.yml`` by itself: robots, their monitors, and who may fulfil whose demands."""
