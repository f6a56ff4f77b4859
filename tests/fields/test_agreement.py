"""What a configuration reads of a message is the same on ROS 1, ROS 2 and DDS, and in bags."""

import json
import re
import subprocess
from pathlib import Path

import pytest

from tests.contract.stages import why_no_dds
from tests.fields import table
from tests.ros1.world import PYTHON, RUNTIME, demand, make_messages, why_no_ros
from tests.ros2.world import RELEASE

pytestmark = [pytest.mark.slow, pytest.mark.ros]

FIELDS = [
    line.split("#")[0].split()
    for line in table.ALL.splitlines()
    if "=" not in line.replace("<=", "")
]
EXPECTED = {name: value for name, (_, value) in table.READS.items()}


def printed(python, on, env):
    """Return what the table prints with another Python."""
    words = [python, str(Path(table.__file__)), on]
    env = {**env, "PYTHONPATH": f"{RUNTIME}:{env.get('PYTHONPATH', '')}"}
    done = subprocess.run(words, env=env, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.fixture(scope="module")
def ros2():
    RELEASE.demand()
    return printed(RELEASE.python, "ros2", RELEASE.fields())


@pytest.fixture(scope="module")
def ros1(tmp_path_factory):
    demand(why_no_ros())
    texts = {"All": table.ALL_OF_ROS1, "Inner": table.INNER}
    made = make_messages(tmp_path_factory.mktemp("ros1") / "made", texts, table.PACKAGE.name)
    env = {"PATH": "/usr/bin:/bin", "LANG": "C.UTF-8", "PYTHONPATH": str(made)}
    return printed(PYTHON, "ros1", env)


def test_ros2(ros2):
    assert ros2["values"] == EXPECTED


def test_wide_strings_and_bytes_above_127_are_read_on_ros2(ros2):
    assert ros2["wide"] == ["grün", 200]


def test_ros1(ros1):
    assert ros1["values"] == EXPECTED


def test_dds_reads_the_bytes_of_ros2(ros2):
    if reason := why_no_dds():
        pytest.skip(reason)
    from eddi_runtime.transports.dds.messages import message_classes

    texts = [f"{re.sub('<=[0-9]', '', of)} {name}" for of, name, *_ in FIELDS]
    classes = message_classes(
        {
            "builtin_interfaces/Time": "int32 sec, uint32 nanosec",
            "builtin_interfaces/Duration": "int32 sec, uint32 nanosec",
            "std_msgs/Header": "builtin_interfaces/Time stamp, string frame_id",
            "field_msgs/Inner": "int32 value, string name",
            "field_msgs/All": ", ".join(texts).replace("Inner", "field_msgs/Inner"),
        }
    )
    message = classes.field_msgs_All.deserialize(bytes.fromhex(ros2["data"]))
    assert table.read(message) == EXPECTED


@pytest.mark.parametrize("on", ["ros1", "ros2"])
def test_bags(on, request):
    pytest.importorskip("rosbags", reason="the extra `bags` is not installed")
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    data = bytes.fromhex(request.getfixturevalue(on)["data"])
    store = get_typestore(Stores.ROS1_NOETIC if on == "ros1" else Stores.ROS2_KILTED)
    text = table.ALL_OF_ROS1 if on == "ros1" else table.ALL
    store.register(get_types_from_msg(table.INNER, "field_msgs/msg/Inner"))
    store.register(get_types_from_msg(text, "field_msgs/msg/All"))
    read = store.deserialize_ros1 if on == "ros1" else store.deserialize_cdr
    assert table.read(read(data, "field_msgs/msg/All")) == EXPECTED
