"""``eddi_config.yml``: how one model is connected to a robot (SESAME D7.2 Figs 32 and 39)."""
