# fmt: off
"""Start the monitor ConSertB.

One namespace per robot: ros2 launch eddi_monitor_launcher eddi.launch.py namespace:=robot1 starts
all monitors of one robot.
"""
import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

# -----Manual edit begin-----  # region: launch.module of:e3b0c442
# -----Manual edit end-----  # region: launch.module


def generate_launch_description():
    """Return the node and the arguments of this file."""
    share = get_package_share_directory('consertb')
    parameters = os.path.join(share, 'config', 'parameters.yaml')
    return LaunchDescription([
        DeclareLaunchArgument(
            'namespace', default_value='', description='of the robot, above relative topics'),
        DeclareLaunchArgument(
            'parameters', default_value=parameters, description='YAML file of parameters'),
        DeclareLaunchArgument(
            'use_sim_time', default_value='false', description='take the time from /clock'),
        # -----Manual edit begin-----  # region: launch.node of:afb2737b
        Node(
            package='consertb',
            executable='ros_node',
            name='consertb',
            namespace=LaunchConfiguration('namespace'),
            parameters=[
                LaunchConfiguration('parameters'),
                {'use_sim_time': LaunchConfiguration('use_sim_time')},
            ],
            remappings=[],
            output='screen',
            respawn=True,
            respawn_delay=2.0,
        ),
        # -----Manual edit end-----  # region: launch.node
        # -----Manual edit begin-----  # region: launch.own of:e3b0c442
        # -----Manual edit end-----  # region: launch.own
    ])
