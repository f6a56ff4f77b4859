"""State machines: faults and their repair, over sources and over what other monitors tell."""

import json
import re
from collections.abc import Iterator
from random import Random
from typing import Any

from tests.deployments.pool.templates import GOOD, SOURCES, Config, Slot, Template

_WAYS = [SOURCES["flag"], *(GOOD[one] for one in ("verdict of guarantee", "hazard is false"))]
_STATES = [{"name": "Ready", "start": True}, {"name": "Slow"}, {"name": "Failed", "fail": True}]
_ALWAYS = (  # while nothing is known, any state may become any other
    ("Ready", "Failed", "fault"),
    ("Slow", "Failed", "fault"),
    ("Failed", "Ready", "repaired"),
    ("Ready", "Slow", "dirty"),
)
_MORE = (("Slow", "Ready", "clean"), ("Failed", "Slow", "dirty; clean"))
_TEXTS = {"fault": ("NOT a", "n > 60"), "dirty": ("n > 20", "NOT b"), "clean": ("n < 20", "b")}


def machines(count: int) -> Iterator[Template]:
    """Yield machines that start in any state, and come to know it by their triggers."""
    for number in range(count):
        rng = Random(f"machine {number}")
        arcs = [*_ALWAYS, *rng.sample(_MORE, rng.randint(0, 2))]
        rng.shuffle(arcs)
        yield _machine(f"machine{number}", arcs, rng)


def _machine(name: str, arcs: list[tuple[str, str, str]], rng: Random) -> Template:
    rows = [{"from": source, "to": target, "trigger": text} for source, target, text in arcs]
    states, texts = f"{name}.json", {text.strip() for _, _, of in arcs for text in of.split(";")}
    triggers = {one: rng.choice(_TEXTS.get(one, ("a", "a AND b"))) for one in sorted(texts)}
    config, conditions = Config(name, "StateMachine", ("model", states)), []
    evidence = {"id": "NotFailed", "not_in": "fail_states"}
    config.model = {"start": "unknown", "triggers": triggers, "evidence": [evidence]}
    if rng.random() < 0.3:
        evidence["hold"] = "1 s"
    if rng.random() < 0.5:
        conditions.append(rng.choice(("b AND n < 20", "a AND b")))
        config.model["reset"] = conditions[-1]
    if rng.random() < 0.5:
        config.model["observe"] = {"Failed": "NOT a"}
        triggers["repaired"] = "a"  # what is observed must be possible
    text = str([*triggers.values(), *conditions])
    slots = {one: _slot(one, rng) for one in sorted(set(re.findall(r"\b[abn]\b", text)))}
    for variable, slot in slots.items():
        config.input(variable, slot)
    files = {
        states: json.dumps({"name": name, "states": _STATES, "transitions": rows}),
        f"{name}_config.yml": config.text(),
    }
    return Template(name, "state_machine", files, (*slots.values(),), {"machine": ""})


def _slot(variable: str, rng: Random) -> Slot:
    reading = SOURCES["number"] if variable == "n" else rng.choice(_WAYS)
    good: Any = 10.0 if variable == "n" else True
    return Slot(f"s_{variable}", reading, rng.choice((0.7, 1.2, 1.7)), good=good)
