"""Events: conditions over sources and over what other monitors claim."""

from collections.abc import Iterator
from pathlib import Path
from random import Random
from typing import Any

from tests.deployments.pool.templates import GOOD, SOURCES, Config, Reading, Slot, Template

UNSOUND = {
    "hazard over guarantee": ("g AND n > 60", "HAZARD"),
    "evidence against a guarantee": ("NOT g AND n < 60", "EVIDENCE"),
}
"""Fault -> condition that reads a claim on its wrong side, and polarity."""

_GOOD = {"b": True, "c": False, "n": 10.0, "m": 30.0}


def events() -> Iterator[Template]:
    """Yield every condition, each with its variables read in some way."""
    lines = Path(__file__).with_suffix(".txt").read_text("utf-8").splitlines()
    for number, line in enumerate(lines):
        polarity, _, text = line.partition(" ")
        rng = Random(f"event {number}")
        ways = {name: _way(name, rng) for name in "bcnmgh" if _uses(text, name)}
        yield _event(f"event{number}", text, polarity, ways, rng)
    yield _of_reliability()


def unsound_events() -> Iterator[Template]:
    """Yield events in which silence of a claim is an argument."""
    for number, (fault, (text, polarity)) in enumerate(UNSOUND.items()):
        ways = {name: GOOD["guarantee"] if name == "g" else SOURCES["number"] for name in "gn"}
        yield _event(f"wrong_event{number}", text, polarity, ways, Random(fault), fault)


def _uses(text: str, name: str) -> bool:
    padded = f" {text} "
    return any(
        not padded[k - 1].isalnum() and not padded[k + 1].isalnum()
        for k in range(1, len(padded) - 1)
        if padded[k] == name
    )


def _way(name: str, rng: Random) -> Reading:
    if name in "gh":
        return rng.choice([*GOOD.values()])
    return SOURCES["number" if name in "nm" else "flag"]


def _event(
    name: str, text: str, polarity: str, ways: dict[str, Reading], rng: Random, fault: str = ""
) -> Template:
    config = Config(name, "Event", ("file", f"{name}.events"))
    slots, variables = [], []
    for variable, reading in ways.items():
        limit = rng.choice((0.7, 1.2) if reading.offer in SOURCES else (1.2, 1.7))
        slot = Slot(f"s_{variable}", reading, limit, good=_GOOD.get(variable))
        slots.append(slot)
        variables.append(_declared(variable, slot, rng))
        age: dict[str, Any] = {"max_age": "none"} if "TIMEOUT" in variables[-1] else {}
        config.input(variable, slot, **age)
    lines = [*variables, f"EVENT {name} ({polarity}) := {text}"]
    files = {f"{name}.events": "\n".join(lines) + "\n", f"{name}_config.yml": config.text()}
    offers = {polarity.lower(): ""}
    return Template(name, "event", files, tuple(slots), offers, fault=fault)


def _declared(name: str, slot: Slot, rng: Random) -> str:
    """Return the declaration of a variable; its TIMEOUT may be its only limit."""
    kind = "NUMBER" if slot.reading.type == "float" else "BOOL"
    assert slot.limit is not None
    timeout = f" TIMEOUT {round(slot.limit * 1000)}ms" if rng.random() < 0.4 else ""
    return f"VAR {name} : {kind}{timeout}"


def _of_reliability() -> Template:
    reading = GOOD["number of fit"]
    slot = Slot("s_r", reading, 1.2)
    config = Config("event_fit", "Event", ("file", "event_fit.events"))
    config.source(slot)
    for variable, kind, path in (("ok", "bool", "valid"), ("p", "float", "p_fail")):
        row = {"id": variable, "type": kind, "requires": ["s_r"], "field": path, "max_age": 1.2}
        config.inputs.append(row)
    text = "VAR ok : BOOL\nVAR p : NUMBER\nEVENT event_fit (EVIDENCE) := ok AND p < 0.15\n"
    files = {"event_fit.events": text, "event_fit_config.yml": config.text()}
    return Template("event_fit", "event", files, (slot,), {"evidence": ""})
