"""Robots that need each other in a circle: refused, or inactive once all evidence has gone."""

from __future__ import annotations

import pytest

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import has_errors
from eddi_scaffold.deployments.joining import join, packages_of
from eddi_scaffold.deployments.wiring import check_wiring, members_of
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.config_reading import read_config
from eddi_scaffold.monitors.loading import read_models
from eddi_scaffold.platforms import chosen
from tests.data_files import data_text
from tests.fleet.circles import Robots

MODEL = data_text("fleet/circle.yml")
CONFIG = data_text("fleet/circle_config.yml")
ACTIVE = "guarantees[G].active"


def monitor(name: str, robot: str, source: str, how: str, options: str, *, tells: bool = True):
    """Return a monitor whose guarantee needs evidence, or that of another monitor."""
    text = CONFIG.replace("NAME", name).replace("SOURCE", source).replace("INPUT", how)
    text = text.replace("OPTIONS", options)
    text = text.replace("FLEET", f"Fleet: {{robot: {robot}}}\n" if tells else "")
    config, problems = read_config(Source(f"{name}_config.yml", text.encode()))
    assert config is not None, problems
    models = read_models(Source(f"{name}.yml", MODEL.encode())).models
    (made,), _ = join(models, [config], lambda _: read_models(Source("none.yml", b"")))
    return made


def on_topic(of: str) -> tuple[str, str]:
    return f"type: eddi_messages.ConSertOutput, topic: {of}/out", f'field: "{ACTIVE}"'


def by_word(of: str, robots: str = "any", how: str = "type: bool") -> tuple[str, str]:
    peers = f"peers: {{robots: {robots}, model: {of}, digest: 'DIGEST', guarantee: G}}"
    return f"type: eddi_messages.RobotGuarantees, topic: /eddi/peers, {peers}", how


def built(parts, options="", telling=""):
    """Return robot and monitor of each part, by its name and, where several have it, its robot."""
    names = {part: part.partition(" ")[0] for part in parts}
    digests = dict.fromkeys(names.values(), "0" * 64)
    for _ in range(2):  # a digest covers how an input is made, but not of whose word
        found = {}
        for part, (robot, (source, how)) in parts.items():
            model = next((one for one in digests if f"model: {one}," in source), names[part])
            whole = source.replace("DIGEST", digests[model])
            tells = not telling or names[part] in telling
            found[part] = robot, monitor(names[part], robot, whole, how, options, tells=tells)
        digests = {names[p]: one.facts.digest for p, (_, one) in found.items()}
    return found


def refused(found: dict[str, tuple[str, BoundMonitor]]) -> bool:
    """Return whether these cannot be generated, robot by robot, without a deployment file."""
    problems = []
    for robot in {of for of, _ in found.values()}:
        own = [one for of, one in found.values() if of == robot]
        problems += check_wiring(members_of(own))
        problems += packages_of(own, chosen("ros1"), None)[1]
    return has_errors(problems)


TOPIC_STEP = {
    "near": ("a", by_word("far")),
    "both": ("a", on_topic("near")),
    "far": ("b", by_word("both")),
}
STEP_ON_EACH = {
    "near": ("a", by_word("front")),
    "both": ("a", on_topic("near")),
    "back": ("b", by_word("both", "[a]")),
    "front": ("b", on_topic("back")),
}
WORDS_ALONE = {"near": ("a", by_word("far")), "far": ("b", by_word("near"))}
THREE = {
    "near": ("a", by_word("far")),
    "far": ("b", by_word("last")),
    "last": ("c", by_word("near")),
}
ANY = {f"near {robot}": (robot, by_word("near")) for robot in "abcd"}
CHAIN = {"near": ("a", on_topic("both")), "both": ("a", by_word("far")), "far": ("b", by_word("x"))}
ONCE = {
    name: (robot, by_word(of, "any", f'expression: "ONCE(other.{ACTIVE}, 5s)"'))
    for name, robot, of in (("near", "a", "far"), ("far", "b", "last"), ("last", "c", "near"))
}
MAJORITY = ", filter: {kind: majority, window: 5}"


@pytest.mark.parametrize(
    ("parts", "options", "telling", "is_refused"),
    [
        pytest.param(TOPIC_STEP, "", "", True, id="a topic within a robot"),
        pytest.param(STEP_ON_EACH, "", "", True, id="a topic within each robot"),
        pytest.param(WORDS_ALONE, "", "", False, id="words alone"),
        pytest.param(THREE, "", "", False, id="three robots"),
        pytest.param(ANY, "", "", False, id="any of four"),
        pytest.param(ANY, MAJORITY, "", True, id="a filter that remembers"),
        pytest.param(ONCE, "", "", True, id="an expression that remembers"),
        pytest.param(CHAIN, "", "both far", False, id="a topic that nobody is told of"),
    ],
)
def test_a_circle_is_refused_or_ends_with_its_evidence(
    parts, options, telling, is_refused, monkeypatch
):
    found = built(parts, options, telling)
    assert refused(found) is is_refused
    robots = Robots(monkeypatch)
    for robot, one in found.values():
        robots.start(robot, one)
    places = [f"/{robot}/{part.partition(' ')[0]}" for part, (robot, _) in found.items()]
    robots.run(4.0, [f"{place}/fine" for place in places])
    topics = {f"{place}/out" for place in places}
    assert {topic for topic in topics if robots.active[topic] == {"G"}} == topics
    robots.run(20.0)  # all sensors are silent
    still = {topic for topic in topics if robots.active[topic]}
    assert bool(still) is is_refused  # as it would be
