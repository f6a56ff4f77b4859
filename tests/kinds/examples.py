"""The worked example of each kind."""

EXAMPLES = {
    "bayesian_network": ("pedestrian/pedestrian.xml", "pedestrian/eddi_config.yml"),
    "consert": ("rover-events/Rover.yml", "rover-events/eddi_config.yml"),
    "event": ("motor-watch/motor_watch.events", "motor-watch/motor_config.yml"),
    "reliability": ("drone/drone.xml", "drone/reliability_config.yml"),
    "safeml": ("safeml/safeml_config.yml", "safeml/perception_config.yml"),
    "state_machine": ("shuttle/shuttle.xml", "shuttle/shuttle_config.yml"),
}
"""Kind -> its example: the model, and what connects it."""
