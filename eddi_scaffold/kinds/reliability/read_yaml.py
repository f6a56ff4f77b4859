"""``reliability_config.yml``, or its keys in an ``eddi_config.yml``: plain values -> System."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from eddi_runtime.reliability.component import ReliabilityResult

from eddi_scaffold.common import units
from eddi_scaffold.common.identifiers import is_ros_name
from eddi_scaffold.common.problems import Problem, did_you_mean, problem
from eddi_scaffold.kinds.reliability.chains import CONFIGURATIONS, motors_of
from eddi_scaffold.kinds.reliability.read_components import read_chain, read_tree
from eddi_scaffold.kinds.reliability.system import (
    TYPES,
    Chain,
    ComponentModel,
    FaultTree,
    ReliabilitySystem,
    Threshold,
)
from eddi_scaffold.kinds.reliability.values import KEY, Values

KEYS = ("horizon", "mission_time", "top", "models", "thresholds", "on_unknown", "max_gap")
_NAME = re.compile(r"[^\W\d][\w .#/-]{0,99}")
_ID = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_RESULTS = (
    *("t", "header", "model", "mttf_hours", "horizon_seconds", "unknown_inputs", "accepted"),
    *ReliabilityResult._fields,
)
"""Names of what is published and recorded, thresholds apart."""
_Make = Callable[[Values, str], Mapping[str, Any] | None]


def read_system(
    values: Values, library: Mapping[str, ReliabilitySystem], base: ReliabilitySystem | None
) -> tuple[ReliabilitySystem | None, list[Problem]]:
    """Read the keys of a monitor.

    Args:
        values: the keys with their places.
        library: systems that ``model: NAME`` of an entry may name.
        base: the existing content, which is changed; None: nothing.

    Returns:
        The system, None after an error (R001, R002, R004, R005), and all problems.
    """
    components = dict(base.components) if base else {}
    models = values.map("models")
    for name in models.names() if models else ():
        assert models is not None
        entry = models.map(name)
        if _NAME.fullmatch(name) is None:
            models.report("R001.model_name", name, KEY, name=name)
        elif entry is not None:
            known = tuple(base.components) if base else ()
            components.update(_component(name, entry, library, components.get(name), known))
    values.only((*KEYS, "file", "parameters"))
    horizon, moving = _horizon(values, base)
    worst = values.choice("on_unknown", ("inactive", "worst_case"))
    gap = values.quantity("max_gap", units.duration, needs_unit=True, positive=True)
    own = _thresholds(values) if values.has("thresholds") else None
    if values.failed:  # components that cannot be read would be missed by what uses them
        return None, values.problems
    top = values.text("top") or (base.top if base else _top(components, values))
    system = ReliabilitySystem(
        components,
        top,
        horizon,
        moving,
        own if own is not None else base.thresholds if base else (),
        worst == "worst_case" if worst else bool(base and base.worst_case),
        gap * 3600.0 if gap is not None else base.max_gap if base else None,
        place=base.place if base else values.place(),
    )
    if not values.failed and top not in components:
        values.unknown("top", top, "model", components)
    return (None if values.failed else system), values.problems


def _top(components: dict[str, ComponentModel], values: Values) -> str:
    """Return the one model that no other uses; several become a series."""
    used = {name for component in components.values() for name in component.below}
    free = [name for name in components if name not in used] or list(components)
    if len(free) == 1:
        return free[0]
    if not free:
        values.report("R001.no_model")
        return ""
    name = "all" if "all" not in components else "all_models"
    components[name] = ComponentModel(name, "series", uses=tuple(free), place=values.place())
    return name


def _horizon(values: Values, base: ReliabilitySystem | None) -> tuple[float, bool]:
    longest = values.quantity("mission_time", units.duration, positive=True)
    if values.text("horizon") == "mission_end":
        if longest is None:
            values.report("R001.no_mission_time", "horizon")
        return longest or 1.0, True
    if longest is not None:
        values.problems.append(
            problem("R001.useless_mission_time", values.place("mission_time", KEY))
        )
    given = values.quantity("horizon", units.duration, positive=True)
    if given is None:
        return (base.horizon, base.mission_end) if base else (1.0, False)
    return given, False


def _thresholds(values: Values) -> tuple[Threshold, ...]:
    found: dict[str, Threshold] = {}
    owners: dict[str, str] = {}  # of topics
    for entry in values.maps("thresholds"):
        entry.only(("id", "activate", "release", "hold", "topic"))
        name = entry.text("id", required=True)
        activate = entry.number("activate", 0.0, 1.0, required=True)
        release = entry.number("release", 0.0, 1.0)
        hold = entry.quantity("hold", units.duration, needs_unit=True)
        topic = entry.text("topic")
        if topic is not None and not is_ros_name(topic):
            expected = "a ROS name is expected: letters, digits, `_` and `/`, such as /rte/land"
            entry.report("R002.topic", "topic", expected=expected)
        if name is None or activate is None:
            continue
        _check_id(entry, name)
        if name in found:
            entry.report("R001.same_name", "id", name=name)
        other = owners.setdefault(topic, name) if topic else name
        if other != name:
            entry.report("R001.same_topic", "topic", first=other, second=name, topic=topic)
        if release is not None and release < activate:
            entry.report("R001.release", "release", name=name, release=release, activate=activate)
        release = activate if release is None else release
        seconds = 3600.0 * (hold or 0.0)
        found[name] = Threshold(name, activate, release, seconds, topic, entry.place())
    return tuple(found.values())


def _check_id(entry: Values, name: str) -> None:
    if _ID.fullmatch(name) is None:
        entry.report("R001.id", "id", name=name)
    elif name in _RESULTS:
        entry.report("R001.reserved", "id", name=name, results=", ".join(_RESULTS))


def _component(
    name: str,
    entry: Values,
    library: Mapping[str, ReliabilitySystem],
    before: ComponentModel | None,
    known: Sequence[str] = (),
) -> Mapping[str, ComponentModel]:
    given = entry.text("type")
    kind = given or (before.type if before else None)
    if kind not in TYPES:
        if kind is None:
            hint = _type_of(entry.text("model"), library)
            if known:
                hint = did_you_mean(name, known) or f"the model has {', '.join(known)}; {hint}"
            entry.report("R001.no_type", hint=hint, name=name)
        else:
            entry.unknown("type", kind, "type", TYPES)
        return {}
    if kind in ("markov", "fault_tree"):
        return _content(name, kind, entry, library, before)
    if kind == "series":
        entry.only(("type", "of"))
        uses = entry.texts("of", required=True)
        if entry.value("of") == []:
            entry.report("R005.series", "of", name=name)
        return {name: ComponentModel(name, kind, uses=uses, place=entry.place())}
    values = _MAKERS[kind](entry, name)
    if values is None:
        return {}
    return {name: ComponentModel(name, kind, values=values, place=entry.place())}


def _type_of(wanted: str | None, library: Mapping[str, ReliabilitySystem]) -> str:
    system = library.get(wanted or "")
    if system is not None:
        return f"write `type: {system.components[system.top].type}`"
    return f"write `type:` and one of {', '.join(TYPES)}"


def _content(
    name: str,
    kind: str,
    entry: Values,
    library: Mapping[str, ReliabilitySystem],
    before: ComponentModel | None,
) -> Mapping[str, ComponentModel]:
    found: dict[str, ComponentModel] = {}
    source = before
    wanted = entry.text("model")
    if wanted is not None:
        system = library.get(wanted)
        if system is None or system.components[system.top].type != kind:
            fitting = [n for n, s in library.items() if s.components[s.top].type == kind]
            entry.unknown("model", wanted, kind.replace("_", " "), fitting)
            return {}
        source = system.components[system.top]
    own = source.content if source else None
    content: FaultTree | Chain | None
    if kind == "markov":
        content = read_chain(name, entry, own if isinstance(own, Chain) else None)
    else:
        content = read_tree(name, entry, own if isinstance(own, FaultTree) else None)
    if content is None:
        return {}
    component = ComponentModel(name, kind, content, place=entry.place())
    if wanted is not None:  # the chains that the tree of the file is bound to
        system = library[wanted]
        found = {n: system.components[n] for n in component.below if n in system.components}
    return {**found, name: component}


def _propulsion(entry: Values, name: str) -> Mapping[str, Any] | None:
    entry.only(("type", "configuration", "rate", "rates", "positions", "status", "repair"))
    configuration = entry.text("configuration", required=True)
    if configuration is None:
        return None
    motors = motors_of(configuration)
    if motors is None:
        entry.report(
            "R001.configuration",
            "configuration",
            hint=_layouts(configuration),
            configuration=configuration,
        )
        return None
    rates = entry.quantities("rates", units.rate)
    one = entry.quantity("rate", units.rate)
    if entry.has("rate") == entry.has("rates"):
        entry.report("R001.rate", name=name)
        return None
    if rates is None and one is None:
        return None
    if rates is not None and len(rates) != motors:
        entry.report(
            "R005.rates", "rates", rates=len(rates), configuration=configuration, motors=motors
        )
        return None
    positions = entry.value("positions", list(range(motors)))
    if not isinstance(positions, list) or sorted(map(repr, positions)) != sorted(
        map(repr, range(motors))
    ):
        entry.report("R005.positions", "positions", last=motors - 1)
        return None
    return {
        "configuration": configuration,
        "rates": rates if rates is not None else [one] * motors,
        "positions": positions,
        "status": entry.choice("status", ("motors", "list")) or "motors",
        "repair": entry.boolean("repair"),
    }


def _layouts(given: str) -> str:
    """Return which frames there are with as many motors, or what was meant."""
    if set(given) <= {"P", "N"}:
        fitting = [name for name, motors in CONFIGURATIONS.items() if motors == len(given)]
        if fitting:
            return f"layouts with {len(given)} motors: {', '.join(fitting)}, P and N exchanged too"
        return f"none has {len(given)} motors; there are: {', '.join(CONFIGURATIONS)}"
    return did_you_mean(given, CONFIGURATIONS) or f"there are: {', '.join(CONFIGURATIONS)}"


_HEAT = ("t_ref", "t_max", "activation_energy")


def _battery(entry: Values, _: str) -> Mapping[str, Any] | None:
    keys = ("failure_rate", "alpha", "beta", "degradation")
    entry.only(("type", *keys, *_HEAT, "repair"))
    found: dict[str, Any] = {key: entry.quantity(key, units.rate, required=True) for key in keys}
    if any(entry.has(key) for key in _HEAT):
        found["t_ref"] = entry.temperature("t_ref")
        found["t_max"] = entry.temperature("t_max")
        found["activation_energy"] = entry.number("activation_energy", 0.0, 10.0, required=True)
    return {**found, "repair": entry.boolean("repair")}


def _processor(entry: Values, _: str) -> Mapping[str, Any] | None:
    keys = ("mttf_ref", "t_ref", "t_max", "u_max", "activation_energy", "shape", "age")
    _only_with_idle_repair(entry, ("type", *keys), "it is never observed to have failed")
    age = entry.quantity("age", units.duration)
    mean = entry.quantity("mttf_ref", units.duration, required=True)
    if mean == 0.0:
        entry.report("R002.mttf_ref", "mttf_ref")
    return {
        "mttf_ref": mean,
        "t_ref": entry.temperature("t_ref"),
        "t_max": entry.temperature("t_max"),
        "u_max": entry.number("u_max", 0.0, 1e6, required=True),
        "activation_energy": entry.number("activation_energy", 0.0, 10.0, default=0.3),
        "shape": entry.number("shape", 0.01, 100.0, default=1.0),
        **({"age": age} if age is not None else {}),
    }


def _k_out_of_n(entry: Values, _: str) -> Mapping[str, Any] | None:
    keys = ("type", "k", "rate", "max")
    _only_with_idle_repair(entry, keys, "it follows its input, and what returns is available again")
    k = entry.whole("k", 1, 10_000, required=True)
    return {
        "k": k,
        "rate": entry.quantity("rate", units.rate, required=True),
        "max": entry.whole("max", k or 1, 10_000),
    }


def _only_with_idle_repair(entry: Values, keys: Sequence[str], why: str) -> None:
    """Report unknown keys, and `repair`, which has an effect on other types."""
    if "repair" in entry.names():
        entry.report("R001.useless_repair", "repair", KEY, type=entry.text("type"), reason=why)
    entry.only((*keys, "repair"))


_MAKERS: Mapping[str, _Make] = {
    "propulsion": _propulsion,
    "battery": _battery,
    "processor": _processor,
    "k_out_of_n": _k_out_of_n,
}


def with_rate(system: ReliabilitySystem, frequency: float | None) -> ReliabilitySystem:
    """Return the system for so many steps per second."""
    return system if frequency is None else replace(system, quantum=1.0 / frequency)
