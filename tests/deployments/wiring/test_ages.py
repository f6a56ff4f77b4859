"""Age limits of what one monitor reads of another."""

from pathlib import Path

import pytest

from eddi_scaffold.common.problems import Problem
from eddi_scaffold.deployments.checking import check_files
from eddi_scaffold.deployments.lifetimes import bounds
from eddi_scaffold.deployments.support import WiredMonitor, acceptances
from eddi_scaffold.deployments.wiring import members_of
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.packages.assembly import monitors_of
from tests.data_files import tabled
from tests.deployments.wiring.test_wiring import CONFIG, CONSERT

LINK = "  - {{id: b, type: eddi_messages.ConSertOutput, topic: {}/out}}"
SENSOR = "  - {id: s, type: std_msgs.Bool, topic: /fine}"
READ = "requires: [b], field: 'guarantees[G].active'"


def chain(folder: Path, *ages: str, frequency: float = 2.0) -> list[WiredMonitor]:
    """Make monitors m0, m1, ... each of which reads the one before it; ages of their inputs."""
    configs = []
    for k, age in enumerate(ages):
        (folder / f"m{k}.yml").write_text(CONSERT.format(), "utf-8")
        sources, input_ = (LINK.format(f"m{k - 1}"), READ) if k else (SENSOR, "requires: [s]")
        text = CONFIG.format(id=f"m{k}", sources=sources, input=input_, topic=f"m{k}/out")
        text = text.replace("max_age: 0.5", f"max_age: {age}")
        text = text.replace("type: ConSert,", f"type: ConSert, frequency: {frequency},")
        configs.append(folder / f"m{k}_config.yml")
        configs[-1].write_text(text, "utf-8")
    return members_of(monitors_of(None, configs)[0])


def test_a_chain_adds_a_period_for_each_monitor(tmp_path: Path) -> None:
    found = bounds(chain(tmp_path, "0.7", "1.2", "1.2"))
    # 0.7 + 3 * 0.5 while all live; whatever dies, every age counts
    assert [(one.claim, round(one.seconds, 9), round(one.any_seconds, 9)) for one in found] == [
        ("m0.G", 1.2, 1.2),
        ("m1.G", 1.7, 2.9),
        ("m2.G", 2.2, 4.6),
    ]
    assert {one.source for one in found} == {"/fine"}
    assert found[2].as_text() == "m2.G goes away at most 2.2 s after /fine fell silent"


def test_without_a_limit_there_is_no_bound(tmp_path: Path) -> None:
    first, second = bounds(chain(tmp_path, "none", "1.2"))
    assert first.as_text() == "m0.G may outlive /fine for ever"
    assert second.as_json() == {
        "claim": "m1.G", "source": "/fine", "bound_s": None, "bound_any_s": None,
    }  # fmt: skip


def test_what_is_accepted_on_a_link_is_not_what_is_accepted_of_a_sensor(tmp_path: Path) -> None:
    (one,) = acceptances(chain(tmp_path, "0.7", "none", "1.2"))
    assert (one.monitor, one.topics, one.claims) == ("m1", ("/m0/out",), ("m1.G", "m2.G"))
    assert one.as_text() == (
        "input 'E' of m1, `max_age: none`: m1.G, m2.G rest on the last value of /m0/out for ever"
    )
    assert one.as_json() == {
        "monitor": "m1", "input": "E", "key": "max_age: none", "accepts": "the last value",
        "topics": ["/m0/out"], "claims": ["m1.G", "m2.G"], "seconds": None,
    }  # fmt: skip


BASE = LINK.format("base")
LIMITED = "requires: [s], max_age: 0.5"


def written(folder: Path, name: str, sources: str, entry: str, frequency: float = 4.0) -> Path:
    """Write a ConSert and its configuration; ``entry`` is what its input is made of."""
    (folder / f"{name}.yml").write_text(CONSERT.format(), "utf-8")
    text = CONFIG.format(id=name, sources=sources, input=entry, topic=f"{name}/out")
    text = text.replace(", max_age: 0.5}]", "}]")
    text = text.replace("type: ConSert,", f"type: ConSert, frequency: {frequency},")
    config = folder / f"{name}_config.yml"
    config.write_text(text, "utf-8")
    return config


def read(*configs: Path) -> tuple[dict[str, BoundMonitor], list[Problem]]:
    monitors, problems = monitors_of(None, configs)
    return {one.package: one for one in monitors}, problems


def limits(monitor: BoundMonitor) -> list[object]:
    return [input_.max_age for input_ in monitor.facts.inputs]


def told(problems: list[Problem]) -> list[list[str]]:
    return [[one.code, one.level] for one in problems if one.code in ("K017", "K029")]


EXPRESSION = "expression: 'b.guarantees[G].active'"
STATUS = BASE.replace("Output", "Status").replace("/out", "/out/status")
READ_STATUS = "expression: 'b.guarantees[G].verdict == 2'"


@tabled
def test_a_message_of_a_monitor_is_unknown_after_a_second(source, entry, limit, found, tmp_path):
    base = written(tmp_path, "base", SENSOR, f"{LIMITED}, field: data")
    top = written(tmp_path, "top", source, entry, 100.0)
    alone, problems = read(top)
    assert (limits(alone["top"]), told(problems)) == ([limit], found)
    together, problems = read(top, base)
    assert (limits(together["top"]), told(problems)) == ([limit], found)
    assert together["top"].compiled.text == alone["top"].compiled.text


@tabled
@pytest.mark.parametrize("how", ["requires", "expression", "status"])
def test_a_publisher_that_is_too_slow_for_the_limit(frequency, age, case, how, tmp_path):
    source = STATUS if how == "status" else BASE
    entry = {"requires": READ, "status": READ_STATUS, "expression": EXPRESSION}[how]
    files = [
        written(tmp_path, "base", SENSOR, LIMITED, frequency),
        written(tmp_path, "top", source, f"{entry}{age}"),
    ]
    for given in (files, files[::-1]):
        problems = [one.case for one in check_files(given) if one.code == "K029"]
        assert problems == ([case] if case else [])


EVENT = """Model: {{id: e, type: Event, model: e.events, frequency: 10}}
SimulatorOutputs: [{{id: x, type: std_msgs/Float32, topic: /x}}]
EDDIInputs: [{{id: x, from: x, max_age: 0.5 s}}]
"""


@tabled
def test_what_holds_on_counts(condition: str, seconds: float, tmp_path: Path) -> None:
    (tmp_path / "e.events").write_text(f"VAR x : NUMBER\nEVENT e {condition}\n", "utf-8")
    (tmp_path / "c.yml").write_text(EVENT.format(), "utf-8")
    (bound,) = bounds(members_of(monitors_of(None, [tmp_path / "c.yml"])[0]))
    assert round(bound.seconds, 9) == seconds


@tabled
def test_windows_of_an_expression_count(expression: str, seconds: float, tmp_path: Path) -> None:
    entry = f"expression: '{expression}', max_age: 0.5"
    config = written(tmp_path, "m", SENSOR, entry)
    (bound,) = bounds(members_of(monitors_of(None, [config])[0]))
    assert round(bound.seconds, 9) == seconds
