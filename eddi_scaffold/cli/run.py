"""``eddi-scaffold run``: a monitor without ROS and without generation."""

from __future__ import annotations
