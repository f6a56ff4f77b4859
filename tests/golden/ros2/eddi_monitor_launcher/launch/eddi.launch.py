# fmt: off
"""Start all monitors of this workspace.

One namespace per robot: ros2 launch eddi_monitor_launcher eddi.launch.py namespace:=robot1
"""
import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration

# -----Manual edit begin-----  # region: launcher.module of:e3b0c442
# -----Manual edit end-----  # region: launcher.module


def generate_launch_description():
    """Return all nodes and the arguments of this file."""
    return LaunchDescription([
        DeclareLaunchArgument(
            'namespace', default_value='', description='of the robot, above relative topics'),
        DeclareLaunchArgument(
            'use_sim_time', default_value='false', description='take the time from /clock'),
        # -----Manual edit begin-----  # region: launcher.include_consertb of:b1f43280
        started('consertb'),
        # -----Manual edit end-----  # region: launcher.include_consertb
        # -----Manual edit begin-----  # region: launcher.own of:e3b0c442
        # -----Manual edit end-----  # region: launcher.own
    ])


def started(name, **own):
    """Return what starts one monitor, with other values of its launch arguments."""
    share = get_package_share_directory(name)
    file = os.path.join(share, 'launch', 'eddi_monitor.launch.py')
    given = {one: LaunchConfiguration(one) for one in ('namespace', 'use_sim_time')}
    given.update(own)
    return IncludeLaunchDescription(
        PythonLaunchDescriptionSource(file), launch_arguments=given.items())
