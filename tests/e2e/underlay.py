"""The two packages of ROS 2's messages that ours need, and that Debian does not have."""

MESSAGES = {
    "builtin_interfaces": {
        "Duration": "int32 sec\nuint32 nanosec\n",
        "Time": "int32 sec\nuint32 nanosec\n",
    },
    "std_msgs": {
        "Bool": "bool data\n",
        "Header": "builtin_interfaces/Time stamp\nstring frame_id\n",
    },
}
MANIFEST = """<package format="3">
  <name>{name}</name>
  <version>1.0.0</version>
  <description>Some messages of ROS 2</description>
  <maintainer email="nobody@example.org">Nobody</maintainer>
  <license>Apache-2.0</license>
  <buildtool_depend>ament_cmake</buildtool_depend>
  {depend}
  <member_of_group>rosidl_interface_packages</member_of_group>
  <export><build_type>ament_cmake</build_type></export>
</package>
"""
BUILD = """cmake_minimum_required(VERSION 3.10)
project({name})
find_package(ament_cmake REQUIRED)
find_package(rosidl_cmake REQUIRED)
find_package(rosidl_generator_c REQUIRED)
find_package(rosidl_generator_cpp REQUIRED)
find_package(rosidl_typesupport_introspection_c REQUIRED)
find_package(rosidl_typesupport_introspection_cpp REQUIRED)
{find}
rosidl_generate_interfaces(${{PROJECT_NAME}} {files} {depend})
ament_package()
"""


def write_underlay(folder):
    """Write the packages below a folder."""
    for name, messages in MESSAGES.items():
        needs = "builtin_interfaces" if name == "std_msgs" else ""
        package = folder / name
        (package / "msg").mkdir(parents=True)
        for message, text in messages.items():
            (package / "msg" / f"{message}.msg").write_text(text)
        depend = f"<depend>{needs}</depend>" if needs else ""
        (package / "package.xml").write_text(MANIFEST.format(name=name, depend=depend))
        find = f"find_package({needs} REQUIRED)" if needs else ""
        files = " ".join(f'"msg/{message}.msg"' for message in messages)
        depend = f"DEPENDENCIES {needs}" if needs else ""
        text = BUILD.format(name=name, find=find, files=files, depend=depend)
        (package / "CMakeLists.txt").write_text(text)
