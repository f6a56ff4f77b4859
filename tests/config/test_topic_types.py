"""Types of messages that packages on this machine have, or do not have."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import Problem
from eddi_scaffold.monitors import message_types
from eddi_scaffold.monitors.config_reading import read_config
from eddi_scaffold.monitors.message_types import common_messages
from eddi_scaffold.monitors.topic_types import check_types
from tests.data_files import write_files

MANIFEST = (
    "<package><name>acme</name><version>1.0.0</version><description>d</description></package>"
)


@pytest.fixture
def ros(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Make a ROS of one package with a message and an action."""
    files = {"msg/Health.msg": "bool fine\n", "action/Dock.action": "---\n---\n"}
    package = write_files(tmp_path / "acme", {"package.xml": MANIFEST, **files})
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path))
    forget()
    yield package
    forget()


def forget() -> None:
    for cached in (  # they look at the machine once
        message_types.installed_message,
        message_types._packages,
    ):
        cached.cache_clear()


def problems(*types: str) -> list[Problem]:
    sources = [f"  - {{id: s{k}, type: {name}, topic: /t{k}}}" for k, name in enumerate(types)]
    text = "\n".join(["Model: {id: m, type: ConSert}", "SimulatorOutputs:", *sources])
    config, result = read_config(Source("c.yml", text.encode()))
    assert config is not None, result
    return list(check_types(config, {"s0", "s1"}))


def test_a_package_of_this_machine_is_known(ros: Path) -> None:
    assert problems("acme.Health") == []
    (result,) = problems("acme.Helth")
    assert (result.code, result.level) == ("K039", "warning")
    (ros / "msg" / "Helth.msg").write_text("bool fine\n")
    forget()
    assert problems("acme.Helth") == []


def test_a_type_that_nobody_knows_is_told_once() -> None:
    result = problems("acme.Health", "acme.Health")
    assert [(entry.code, entry.level) for entry in result] == [("K039", "warning")]


def test_every_common_message_exists() -> None:
    assert problems(*common_messages()) == []
