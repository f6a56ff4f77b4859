"""Options of a network in a configuration: outputs, observed nodes, thresholds as evidence."""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from eddi_runtime.bayesian_network.claims import COMBINATIONS

from eddi_scaffold.common.claims import Use
from eddi_scaffold.common.identifiers import attribute, free_name, is_ros_name
from eddi_scaffold.common.problems import Place, Problem, did_you_mean, has_errors, problem
from eddi_scaffold.common.units import QuantityError, accepted, seconds
from eddi_scaffold.kinds import ModelInput, Options
from eddi_scaffold.kinds.bayesian_network.discretisation import (
    Declaration,
    EntryReader,
    Form,
    is_number,
    read_discretisation,
)
from eddi_scaffold.kinds.bayesian_network.inference_plan import LARGE, TOO_LARGE, Width, width_of
from eddi_scaffold.kinds.bayesian_network.network import (
    Network,
    in_digits,
    node_attributes,
    numbered,
)

_ID = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_RESERVED = ("t", "reason", "unknown", "valid")
"""Columns of what ``run --csv`` writes, and what reads as if it were about all evidence."""


def _is_id(value: object) -> bool:
    return isinstance(value, str) and bool(_ID.fullmatch(value)) and value not in _RESERVED


def _hold_s(value: object) -> float | None:
    try:
        return seconds(value)
    except QuantityError:
        return None


def _are_states(value: object) -> bool:
    states = value if isinstance(value, list) else [value]
    return states != [] and all(isinstance(state, str) for state in states)


_PROBABILITY = (lambda value: is_number(value) and 0 <= value <= 1, "a number from 0 to 1")
_FORM: Form = {
    "id": (_is_id, "a name such as RiskIsLow, and not t, reason, unknown or valid"),
    "node": (lambda value: isinstance(value, str), "a node of the network"),
    "state": (_are_states, "a state (`of: NODE=STATE`), or a list of them, yes and no in quotes"),
    "at_most": _PROBABILITY,
    "at_least": _PROBABILITY,
    "release": _PROBABILITY,
    "hold": (lambda value: _hold_s(value) is not None, "a time such as 2 s, up to a year"),
    "topic": (
        lambda value: isinstance(value, str) and is_ros_name(value),
        "a ROS name: letters, digits, `_` and `/`, such as /rte/land",
    ),
}


@dataclass(frozen=True)
class Threshold:
    """One checked entry."""

    id: str
    node: str
    states: tuple[str, ...]  # whose probabilities are added up
    at_least: bool  # the sum must not be below `limit`; else it must not be above
    limit: float  # where it becomes active
    release: float  # beyond it, it is lost
    hold: float  # seconds for which the limit must be kept before
    topic: str | None  # where it is published alone, `None` for nowhere
    place: Place = field(default=Place(), compare=False)

    def text(self) -> str:
        """Return what it asks for, for people."""
        relation, beyond = (">=", "below") if self.at_least else ("<=", "above")
        held = f" for {self.hold:g} s" if self.hold else ""
        where = f", on {self.topic}" if self.topic is not None else ""
        limit = f"P({self.node} = {' or '.join(self.states)}) {relation} {self.limit:g}"
        return f"{limit}{held}, gone {beyond} {self.release:g}{where}"


def read_thresholds(
    network: Network, options: Options, discretised: Collection[str]
) -> tuple[list[Threshold], list[Problem]]:
    """Check the section ``evidence`` (B303, B305, B404)."""
    section, reader = options.values.get("evidence"), EntryReader(options, "evidence")
    thresholds: list[Threshold] = []
    if section is None:
        section = []
    if not isinstance(section, list) or not all(isinstance(entry, Mapping) for entry in section):
        reader.report("B404.evidence_list")
        return [], reader.problems
    for number, entry in enumerate(section):
        of_entry = _ThresholdReader(network, entry, options, number)
        thresholds += of_entry.read(discretised)
        reader.problems += of_entry.problems
    problems = reader.problems
    for number, threshold in enumerate(thresholds):
        name, place, topic = threshold.id, threshold.place, threshold.topic
        for other in thresholds[:number]:
            if other.id == name:
                problems.append(problem("B404.duplicate_id", place, name=name))
            if topic and other.topic == topic:
                fields = {"other": other.id, "name": name, "topic": topic}
                problems.append(problem("B404.same_topic", place, **fields))
    return thresholds, problems


class _ThresholdReader(EntryReader):
    def __init__(
        self, network: Network, entry: Mapping[str, Any], options: Options, number: int
    ) -> None:
        name = entry.get("id")
        subject = f"evidence {name!r}" if isinstance(name, str) else "evidence"
        super().__init__(options, "evidence", number, entry=entry, subject=subject)
        self._network = network

    def read(self, discretised: Collection[str]) -> list[Threshold]:
        """Return the threshold; nothing after an error."""
        values = self.values(_FORM, "id", "node", "state")
        node, states = values.get("node", ""), values.get("state", [])
        states = [states] if isinstance(states, str) else states
        names = self._network.names()
        if node in discretised:
            self.report("B305.observed", "node", name=node)
        elif node in names:
            known = self._network.node(node).states
            for state in states:
                if state not in known:
                    hint = did_you_mean(state, known) or f"its states: {', '.join(known)}"
                    self.report("B303.threshold_state", "state", hint=hint, state=state)
            if len({*states}) < len(states):
                self.report("B303.state_twice", "state")
            elif {*states} == {*known}:
                self.report("B303.every_state", "state", node=node)
        elif "node" in values:
            similar = did_you_mean(node, names)
            self.report("B303.threshold_node", "node", hint=similar, value=node)
        keys = [key for key in ("at_least", "at_most") if key in self.entry]
        if len(keys) != 1:
            self.report("B404.one_limit", *keys[:1])
        if has_errors(self.problems):
            return []
        (key,) = keys
        limit, is_least = float(values[key]), key == "at_least"
        release = float(values.get("release", limit))
        if release > limit if is_least else release < limit:
            side = "above" if is_least else "below"
            self.report("B404.release", "release", release=release, side=side, key=key, limit=limit)
            return []
        hold_s, topic = _hold_s(values.get("hold", 0)) or 0.0, values.get("topic")
        limits = (is_least, limit, release, hold_s, topic, self.place("id"))
        return [Threshold(values["id"], node, tuple(states), *limits)]


_OWN_FORM: Form = {
    "outputs": (lambda value: isinstance(value, list), "a list of nodes"),
    "observed": (lambda value: isinstance(value, list), "a list of nodes"),
    "evidence_mode": (lambda value: value in ("virtual", "d7.2"), "virtual or d7.2"),
    "on_inconsistent": (
        lambda value: value in ("silent", "prior", "hold"),
        "silent or prior or hold",
    ),
    "explain": (lambda value: isinstance(value, bool), "false or true"),
    "renamed": (lambda value: isinstance(value, Mapping), "a map: new -> former name of a node"),
}


@dataclass(frozen=True)
class NetworkOptions:
    """A network's use, checked."""

    outputs: tuple[str, ...]  # nodes whose posteriors are given, in the order of the network
    # nodes that inputs feed or `observed:` names, in the order of the network
    observed: tuple[str, ...]
    declarations: tuple[Declaration, ...]  # discretised nodes
    direct: Mapping[str, str]  # node -> input that holds its state or likelihoods
    inputs: tuple[ModelInput, ...] = field(compare=False)  # what the monitor reads
    width: Width = field(compare=False)  # what inference will cost
    # node -> its former name; its hand-written body moves along
    renamed: Mapping[str, str] = field(default_factory=dict, compare=False)
    virtual: bool = True  # several non-zero outcomes are likelihoods; else D7.2's rule
    on_inconsistent: str = "silent"  # the result on evidence of probability zero
    explain: bool = False  # the status message has the relevance of each observed node
    thresholds: tuple[Threshold, ...] = ()  # the evidence for ConSerts
    by_hand: tuple[str, ...] = ()  # nodes that a person can make of inputs which feed none

    @property
    def inferred(self) -> tuple[str, ...]:
        """The nodes whose posteriors are computed: the outputs, and what evidence is made of."""
        return tuple(dict.fromkeys([*self.outputs, *(entry.node for entry in self.thresholds)]))

    @property
    def observable(self) -> tuple[str, ...]:
        """The nodes that may be observed, by inputs or by hand."""
        return (*self.observed, *(name for name in self.by_hand if name not in self.observed))

    def input_of(self, node: str) -> str | None:
        """Return the input that feeds a node; a discretisation goes before a name."""
        declared = (entry.input for entry in self.declarations if entry.node == node)
        return next(declared, self.direct.get(node))


def read_options(
    network: Network, options: Options | None
) -> tuple[NetworkOptions | None, list[Problem]]:
    """Read what a configuration says of a network (B301 to B305, B401 to B405).

    Without a configuration there are no problems, however wide the network is.
    """
    has_configuration, options = options is not None, options or Options()
    declarations, problems = read_discretisation(network, options)
    declared, names = {entry.node for entry in declarations}, network.names()
    thresholds, faults = read_thresholds(network, options, declared)
    direct = inputs_named_like_nodes(network, options, declarations)
    own = {key: value for key, value in options.values.items() if key in _OWN_FORM}
    reader = EntryReader(options, entry=own)
    values = reader.values(_OWN_FORM)
    for key in ("outputs", "observed"):
        for number, name in enumerate(values.get(key, ())):
            if name not in names:
                hint = did_you_mean(str(name), names)
                reader.report("B303.unknown_node", key, number, hint=hint, key=key, name=name)
    for name in values.get("renamed", ()):
        if name not in names:
            reader.report("B303.renamed_node", "renamed", name, name=name)
    if values.get("outputs") == []:
        reader.report("B303.no_output", "outputs")
    problems += [*faults, *reader.problems]
    if has_errors(problems):
        return None, problems
    named = values.get("observed", ())
    observed = tuple(name for name in names if name in {*declared, *direct, *named})
    outputs = [name for name in names if name in values.get("outputs", ())]
    if not outputs:  # those that the file marks, else leaves that nobody observes
        parents = {parent for node in network.nodes for parent in node.parents}
        leaves = [name for name in names if name not in parents]
        unseen = [name for name in leaves if name not in observed]
        outputs = [node.id for node in network.nodes if node.target] or unseen or leaves
    inputs = _inputs(network, options, declarations, direct, has_thresholds=bool(thresholds))
    feeding = {*direct.values(), *(entry.input for entry in declarations)}
    inferred = {*outputs, *(entry.node for entry in thresholds)}
    by_hand = named if "observed" in values else [name for name in names if name not in inferred]
    if all(input_.id in feeding for input_ in inputs):
        by_hand = ()
    observable = {*observed, *by_hand}
    width = width_of(
        numbered(network).shape, *(map(names.index, of) for of in (inferred, observable))
    )
    settings = NetworkOptions(
        tuple(outputs),
        observed,
        tuple(declarations),
        direct,
        inputs,
        width,
        {str(new): str(old) for new, old in values.get("renamed", {}).items()},
        values.get("evidence_mode") != "d7.2",
        values.get("on_inconsistent", "silent"),
        values.get("explain", False),
        tuple(thresholds),
        tuple(name for name in by_hand if name not in {*declared, *direct}),
    )
    problems += _warnings(network, settings, options) if has_configuration else ()
    return None if has_errors(problems) else settings, problems


def inputs_named_like_nodes(
    network: Network, options: Options, declarations: Sequence[Declaration]
) -> dict[str, str]:
    """Return node -> input of its state, which has the node's name or its Python name."""
    if not options.inputs and not declarations:  # no configuration yet: an input for each node
        return {name: name for name in network.names()}
    free = {entry.id for entry in options.inputs} - {entry.input for entry in declarations}
    declared = {entry.node for entry in declarations}
    input_of = {}
    for node, attribute_of_node in node_attributes(network).items():
        name = node if node in free else attribute_of_node
        if name in free and node not in declared:
            input_of[node] = name
    return input_of


def _inputs(
    network: Network,
    options: Options,
    declarations: Sequence[Declaration],
    direct: Mapping[str, str],
    *,
    has_thresholds: bool,
) -> tuple[ModelInput, ...]:
    """Return the inputs in the order of the configuration, else one for each node."""
    node_of = {name: node for node, name in direct.items()}
    configured = {entry.id: entry for entry in options.inputs}
    taken: set[str] = set()
    inputs = []
    for name in configured or node_of:
        fed = [entry for entry in declarations if entry.input == name]
        if name in node_of:
            states = ", ".join(network.node(node_of[name]).states)
            text = f"a state of {node_of[name]} ({states}), or likelihoods"
            input_ = ModelInput(name, "state", description=text)
        else:
            unit = configured[name].unit
            type_ = fed[0].type if fed else configured[name].type or "float"
            text = "for the methods in bayesian_network_config.py"
            text = f"becomes a state of {fed[0].node}" if fed else text
            input_ = ModelInput(name, type_, unit=unit, units=accepted(unit), description=text)
        maps = [entry.values_of_map for entry in fed]
        if maps and None not in maps:  # other values leave a node open
            known = [value for of_map in maps for value in of_map or ()]
            input_ = replace(input_, uses=(Use(known.__contains__),))
        if has_thresholds and (fed or name in node_of):
            # Any default of what feeds a node may make evidence active before a message comes.
            input_ = replace(input_, is_good=lambda _: True)
        # Ids may look alike in Python (`CO2 report`, `CO2_report`).
        own_name = free_name(attribute(name), taken)
        taken.add(own_name)
        if own_name != attribute(name):
            input_ = replace(input_, attribute=own_name)
        inputs.append(input_)
    return tuple(inputs)


def _warnings(network: Network, settings: NetworkOptions, options: Options) -> Iterator[Problem]:
    """Yield what is too wide (B301), and evidence that is of little use (B305, B425)."""
    width, observed = settings.width, settings.observable
    if width.largest > LARGE:
        is_refused = width.largest > TOO_LARGE
        yield problem(
            "B301.too_large" if is_refused else "B301.large",
            options.place(),
            entries=in_digits(width.largest),
            limit=TOO_LARGE if is_refused else LARGE,
            nodes=", ".join(width.nodes[:8]) + (", ..." if len(width.nodes) > 8 else ""),
        )
    for entry in settings.thresholds:
        if entry.node in observed:
            place = entry.place
            yield problem("B305.perhaps_observed", place, threshold=entry.id, node=entry.node)
    priors = {entry.node for entry in settings.declarations if entry.reader.policy == "prior"}
    cards = {name: len(network.node(name).states) for name in observed if name not in priors}
    count = math.prod(cards.values())
    if settings.thresholds and count > COMBINATIONS:
        factors = [f"{name} {card}" for name, card in cards.items()]
        shown = " x ".join(factors[:6]) + (" x ..." if len(factors) > 6 else "")
        place, total = options.place("evidence"), in_digits(count)
        yield problem("B425", place, count=total, shown=shown, largest=COMBINATIONS)
