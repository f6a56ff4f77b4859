"""The platform dds: messages of ROS 2, and packages that plain Copier renders in the same way."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from eddi_scaffold.monitors.message_types import known_messages, ros2_messages
from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.platforms import platforms
from eddi_scaffold.platforms.dds import type_hash
from tests.cli.command import run
from tests.diagnosed import assert_reported

CONTRACT = Path(__file__).parents[1] / "contract"
MODEL, CONFIG = CONTRACT / "rover.yml", CONTRACT / "rover_config.yml"


def test_the_messages_of_ros2_are_those_of_rosbags() -> None:
    typesys = pytest.importorskip("rosbags.typesys")
    store = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE).fielddefs
    ours = ros2_messages(known_messages())
    own = {name for name in ours if name.startswith("eddi_messages/")}
    assert len(ours) - len(own) > 100
    for name in ours.keys() - own:
        theirs = {field: spelt(of) for field, of in store[name.replace("/", "/msg/")][1]}
        theirs.pop("structure_needs_at_least_one_member", None)  # of a message without fields
        given = {field: of.replace("char", "uint8") for field, of in ours[name].items()}
        if name == "std_msgs/Char":
            theirs = {"data": "uint8"}
        assert list(given.items()) == list(theirs.items()), name


def test_hashes_are_those_of_rosbags() -> None:
    typesys = pytest.importorskip("rosbags.typesys")
    store = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)
    ours = ros2_messages(known_messages())
    assert type_hash("std_msgs/Bool", ours) == (
        "RIHS01_feb91e995ff9ebd09c0cb3d2aed18b11077585839fb5db80193b62d74528f6c9"
    )
    for name in ours:
        if name.startswith("eddi_messages/"):
            text = "\n".join(f"{of} {field}" for field, of in ours[name].items())
            store.register(typesys.get_types_from_msg(text, name.replace("/", "/msg/")))
    char = type_hash("std_msgs/Char", ours)  # a uint8 in ROS 2, other than in rosbags
    assert char == "RIHS01_3ad2d04dd29ba19d04b16659afa3ccaedd691914b02a64e82e252f2fa6a586a9"
    with_marker = [name for name in ours if name.startswith("visualization_msgs/Interactive")]
    for name in ours.keys() - {"std_msgs/Char", *with_marker}:
        assert type_hash(name, ours) == store.hash_rihs01(name.replace("/", "/msg/")), name


def spelt(of: tuple) -> str:
    """Return a type of rosbags as a ``.msg`` file has it."""
    kind, value = int(of[0]), of[1]
    if kind == 1:
        return value[0]
    if kind == 2:
        return value.replace("/msg/", "/")
    item, length = value
    return f"{spelt(item)}[{length}]" if kind == 3 else f"{spelt(item)}[]"


def test_a_definition_comes_after_those_that_it_is_made_of(tmp_path: Path) -> None:
    parts = {"value": "float64"}
    own = {"header": "Header", "one": "my_msgs/Part[2]", "age": "duration"}
    config = yaml.safe_load(CONFIG.read_text("utf-8"))
    config["SimulatorOutputs"][1]["type"] = "my_msgs/Range"
    config["EDDIInputs"][1]["field"] = "one[0].value"
    config["MessageTypes"] = {"my_msgs/Range": own, "my_msgs/Part": parts}
    path = tmp_path / "config.yml"
    path.write_text(yaml.safe_dump(config, sort_keys=False), "utf-8")
    (monitor,), _ = monitors_of(MODEL, [path])
    package, problems = platforms()["dds"].monitor(monitor)
    assert problems == []
    fields = {row["name"]: row["fields"] for row in package.answers["definitions"]}
    assert list(fields).index("my_msgs/Part") < list(fields).index("my_msgs/Range")
    assert fields["my_msgs/Range"] == (
        "std_msgs/Header header, my_msgs/Part[2] one, builtin_interfaces/Duration age"
    )
    parts["again"] = "my_msgs/Range"
    path.write_text(yaml.safe_dump(config, sort_keys=False), "utf-8")
    (monitor,), _ = monitors_of(MODEL, [path])
    _, problems = platforms()["dds"].monitor(monitor)
    assert_reported("K048", problems)


def test_a_hand_edit_and_the_order_of_fields_survive_an_upgrade(tmp_path: Path) -> None:
    own = "MessageTypes:\n  my_msgs/Part: {value: float64, last: bool, first: int32}\n"
    text = CONFIG.read_text("utf-8").replace("std_msgs/msg/Float64", "my_msgs/msg/Part")
    config = tmp_path / "config.yml"
    config.write_text(own + text.replace("field: data, unit", "field: value, unit"), "utf-8")
    words = ("generate", "--platform", "dds", "-o", ".", "-m", MODEL, "-c", config)
    assert run(*words, cwd=tmp_path).status == 0
    code = tmp_path / "rover" / "EDDIInput.py"
    mine = code.read_text("utf-8").replace("clear.value\n", "clear.value / 1000\n")
    code.write_text(mine, "utf-8")
    assert run("upgrade", "rover", cwd=tmp_path).status == 0
    assert code.read_text("utf-8") == mine
    order = "'my_msgs/Part': 'float64 value, bool last, int32 first'"
    assert order in (tmp_path / "rover" / "messages.py").read_text("utf-8")
    transports = {path.name for path in (tmp_path / "eddi_runtime/transports").iterdir()}
    assert transports == {"__init__.py", "dds"}
    assert run("status", "rover", cwd=tmp_path).status == 0
