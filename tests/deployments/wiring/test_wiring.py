"""Monitors together: robots, rings, and what a monitor reads of another one by way of others."""

from pathlib import Path

import pytest

from eddi_scaffold.common.problems import EddiError, Problem
from eddi_scaffold.deployments.support import WiredMonitor, wired
from eddi_scaffold.deployments.topics import Deployment
from eddi_scaffold.deployments.wiring import check_wiring
from eddi_scaffold.packages.assembly import monitors_of

CONSERT = """\
guarantees: [{{id: G, dimensions: [{{Binary: {{type: Fine}}}}]}}]
demands: []
evidence: [{{id: E, dimension: {{Binary: {{type: Fine}}}}}}]
gates: []
tree_propagations: [{{from: E, to: G}}]
required_services: []
provided_services: []
"""
CONFIG = """\
Model: {{id: {id}, type: ConSert, parameters: [{{model: {id}.yml}}]}}
SimulatorOutputs:
{sources}
EDDIInputs: [{{id: E, type: bool, {input}, max_age: 0.5}}]
EDDIOutputs: [{{id: out, topic: {topic}}}]
"""


def member(
    folder: Path, id_: str, topic: str, sources: str, input_: str, namespace: str = ""
) -> WiredMonitor:
    (folder / f"{id_}.yml").write_text(CONSERT.format(), "utf-8")
    config = folder / f"{id_}_config.yml"
    text = CONFIG.format(id=id_, sources=sources, input=input_, topic=topic)
    config.write_text(text, "utf-8")
    (monitor,), _ = monitors_of(None, [config])
    return wired(monitor, namespace)


def codes(problems: list[Problem]) -> list[str]:
    return [problem.code for problem in problems]


SENSOR = "  - {id: s, type: std_msgs.Bool, topic: /fine}"


@pytest.mark.parametrize(("topic", "expected"), [("/base/out", ["D005"]), ("base/out", [])])
def test_two_robots_share_an_absolute_topic(
    topic: str, expected: list[str], tmp_path: Path
) -> None:
    robots = [
        member(tmp_path, "base", topic, SENSOR, "requires: [s]", f"/robot{number}")
        for number in (1, 2)
    ]
    found = check_wiring(robots)
    assert codes(found) == expected
    if found:
        assert found[0].message == (
            "two robots share /base/out: /robot1/base and /robot2/base publish the same topic"
            " /base/out"
        )
        assert found[0].hint == "write base/out, relative to the namespace of each robot"


def test_a_relative_topic_stays_with_its_robot(tmp_path: Path) -> None:
    base = [member(tmp_path, "base", "base/out", SENSOR, "requires: [s]", f"/r{k}") for k in (1, 2)]
    guarantee = "  - {id: b, type: eddi_messages.ConSertOutput, topic: base/out}"
    field = "requires: [b], field: 'guarantees[G].active'"
    user = member(tmp_path, "user", "user/out", guarantee, field, "/r2")
    together = Deployment([*base, user])
    (source,) = user.config.config.SimulatorOutputs
    found = together.publisher(user, source)
    assert found is not None
    assert found.member is base[1]


def test_a_value_alone_is_not_read(tmp_path: Path) -> None:
    """A guarantee on a std_msgs topic: false is also UNKNOWN there, whatever it is read for."""
    member(tmp_path, "base", "base/out", SENSOR, "requires: [s]")
    path = tmp_path / "base_config.yml"
    text = path.read_text("utf-8").replace(
        "EDDIOutputs: [", "EDDIOutputs: [{id: g, topic: base/g, field: 'guarantees[G].active'}, "
    )
    path.write_text(text, "utf-8")
    base = wired(monitors_of(None, [path])[0][0])
    source = "  - {id: g, type: std_msgs.Bool, topic: base/g}"
    good = member(tmp_path, "good", "good/out", source, "requires: [g]")
    bad = member(tmp_path, "bad", "bad/out", source, 'expression: "NOT g.data"')
    for reader in (good, bad):
        (found,) = check_wiring([base, reader])
        assert found.code == "D001"
        assert found.hint == (
            "read `guarantees[G].active` of eddi_messages/ConSertOutput, on the topic of the"
            " whole message of base"
        )
        assert codes(check_wiring([base], [reader])) == ["D001"]


def test_class_names_are_the_ids_that_others_read(tmp_path: Path) -> None:
    """With ``guarantee_ids: class``, also around a ring and where the id of the model is used."""
    ring = []
    for name, other in (("a", "b"), ("b", "a")):
        (tmp_path / f"{name}.yml").write_text(CONSERT.format().replace("G", "all_fine"), "utf-8")
        source = f"  - {{id: s, type: eddi_messages.ConSertOutput, topic: {other}/out}}"
        text = CONFIG.format(
            id=name,
            sources=source,
            input="requires: [s], field: 'guarantees[AllFine].active'",
            topic=f"{name}/out",
        )
        path = tmp_path / f"{name}_config.yml"
        path.write_text(text.replace("type: ConSert", "type: ConSert, guarantee_ids: class"))
        ring.append(path)
    with pytest.raises(EddiError) as refused:
        monitors_of(None, ring)
    assert codes(list(refused.value.problems)) == ["D003"]
    ring[0].write_text(ring[0].read_text("utf-8").replace("AllFine", "all_fine"))
    with pytest.raises(EddiError) as refused:
        monitors_of(None, ring)
    assert "b publishes no 'all_fine'" in str(refused.value)


def test_silence_is_followed_through_another_input(tmp_path: Path) -> None:
    """An expression that turns another input round turns what that one reads round."""
    member(tmp_path, "base", "base/out", SENSOR, "requires: [s]")
    source = "  - {id: b, type: eddi_messages.ConSertOutput, topic: base/out}"
    (tmp_path / "e.events").write_text(
        "VAR g : BOOL TIMEOUT 1s\nVAR h : BOOL TIMEOUT 1s\nEVENT ok (EVIDENCE) := h AND (g OR h)",
        "utf-8",
    )
    config = tmp_path / "e_config.yml"
    config.write_text(
        f"Model: {{id: e, type: Event, parameters: [{{file: e.events}}]}}\n"
        f"SimulatorOutputs:\n{source}\n"
        "EDDIInputs:\n"
        "  - {id: g, type: bool, requires: [b], field: 'guarantees[G].active', max_age: 1}\n"
        "  - {id: h, type: bool, expression: NOT g, max_age: 1}\n"
        "EDDIOutputs: [{id: o, topic: e/out}]\n",
        "utf-8",
    )
    with pytest.raises(EddiError) as refused:
        monitors_of(None, [tmp_path / "base_config.yml", config])
    (problem,) = refused.value.problems
    assert (problem.code, problem.message.partition(" by ")[0]) == (
        "D001", "input 'g' gains from silence",
    )  # fmt: skip
