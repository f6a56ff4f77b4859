"""Readers of the MROS models ``.rossystem``, ``.ros``, ``.ros1``, ``.ros2``, usable alone.

    from pathlib import Path
    from eddi_scaffold.mros import read_rossystem

    system = read_rossystem(Path("robot.rossystem").read_bytes(), "robot.rossystem")
    for component in system.components:
        print(component.name, [interface.ref for interface in component.interfaces])

"MROS" is the family of languages of ipa320/ros-model, today ipa320/RosTooling (model based ROS).
It is not the RobMoSys project MROS (metacontrol for ROS), although that one also wrote
``.rossystem`` files.
"""

from eddi_scaffold.mros.model import RosModel, System
from eddi_scaffold.mros.reading import read_ros_models, read_rossystem
from eddi_scaffold.mros.text import MrosSyntaxError

MODEL_SUFFIXES = (".ros", ".ros1", ".ros2")
SYSTEM_SUFFIX = ".rossystem"

__all__ = [
    "MODEL_SUFFIXES",
    "SYSTEM_SUFFIX",
    "MrosSyntaxError",
    "RosModel",
    "System",
    "read_ros_models",
    "read_rossystem",
]
