"""What is wrong with a system that was read: before anything is computed of it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

from eddi_scaffold.common.problems import Place, Problem, SimilarNames, error, has_errors, warning
from eddi_scaffold.kinds.reliability import chains
from eddi_scaffold.kinds.reliability.cut_sets import LIMIT, CutSet, minimal_cut_sets
from eddi_scaffold.kinds.reliability.fault_tree import COHERENT, NODE_LIMIT, TooLargeError
from eddi_scaffold.kinds.reliability.inputs import MISSION_END, inputs_of
from eddi_scaffold.kinds.reliability.lowering import chain_of, lower_tree, used
from eddi_scaffold.kinds.reliability.system import (
    DYNAMIC,
    Chain,
    ComponentModel,
    FaultTree,
    Gate,
    ReliabilitySystem,
    order,
)

MAX_STATES = 2000
_LARGE = 500
_LARGEST_RATE = 1e12


def check_chain(name: str, chain: Chain, place: Place) -> Iterator[Problem]:
    """Yield the problems of a chain (R002, R007, R013)."""
    broken = False
    if len(chain.initial) != 1:
        found = f"the initial states {', '.join(chain.initial)}" if chain.initial else "none"
        message = f"chain {name!r} needs exactly one initial state, it has {found}"
        yield error("R007", message, place)
        broken = True
    if not chain.fail:
        message = f"chain {name!r} has no fail state"
        yield error("R007", message, place, "mark a state: isFailState, or `fail:` in YAML")
        broken = True
    failed = next((state for state in chain.initial if state in chain.fail), None)
    if failed is not None and len(chain.initial) == 1:
        yield error("R007", starts_failed(failed), place)
        broken = True
    if len(chain.states) > MAX_STATES:
        message = f"chain {name!r} has {len(chain.states)} states, the limit is {MAX_STATES}"
        yield error("R002", message, place)
        broken = True
    for arc in chain.arcs:
        if arc.rate > _LARGEST_RATE:
            message = (
                f"the rate {arc.rate:g} 1/h from {arc.source!r} to {arc.target!r} of chain "
                f"{name!r} is out of range, 0 to {_LARGEST_RATE:.15g} 1/h"
            )
            yield error("R002", message, arc.place)
            broken = True
    if not broken:
        yield from _reach(name, chain, place)


def starts_failed(state: str) -> str:
    """Return what is wrong with a chain that begins in a fail state."""
    return f"the initial state {state!r} is a fail state: p_fail is 1 from the start"


def _reach(name: str, chain: Chain, place: Place) -> Iterator[Problem]:
    for state in chain.fail:
        if any(arc.source == state and arc.rate > 0.0 for arc in chain.arcs):
            message = f"fail state {state!r} of chain {name!r} has arcs, which are left out"
            hint = "failure is first passage: what comes after it is ignored"
            yield warning("R013", message, place, hint)
    lowered = chain_of(chain)
    reached = chains.reached(lowered)
    lost = [state for number, state in enumerate(chain.states) if number not in reached]
    if lost:
        shown = ", ".join(lost[:8]) + (", ..." if len(lost) > 8 else "")
        yield warning("R013", f"chain {name!r} never reaches {shown}", place)
    if lowered.initial not in chains.reaching(lowered, lowered.fail):
        message = f"chain {name!r} cannot fail: no path leads from {chain.initial[0]!r} to failure"
        yield warning("R013", message, place, "its MTTF is infinite")
    elif lowered.initial not in chains.certain(lowered):
        message = f"chain {name!r} may stay for ever in states that cannot fail"
        yield warning("R013", message, place, "its MTTF is infinite")
    count = len(chain.states)
    if count > _LARGE:
        size = 8e-6 * count**2
        message = f"chain {name!r} has {count} states: {size:.0f} MB for each matrix"
        yield warning("R013", message, place)


_ALL = "\0"
"""Stands above all models; no model is called so."""


def check_system(system: ReliabilitySystem) -> list[Problem]:
    """Return all problems of the models that the top uses (R001, R005 to R016)."""
    problems = list(_references(system))
    if has_errors(problems):
        return problems
    for component in used(system).components.values():
        if isinstance(component.content, Chain):
            problems += check_chain(component.name, component.content, component.place)
        elif isinstance(component.content, FaultTree):
            problems += _tree(component, component.content)
    if has_errors(problems):
        return problems
    return [*problems, *_open_ports(system), *_dependence(system), *_inputs(system)]


def _open_ports(system: ReliabilitySystem) -> Iterator[Problem]:
    """Refuse evidence from trees that leave out unconnected ports."""
    if not system.thresholds:
        return
    for component in used(system).components.values():
        tree = component.content
        if not isinstance(tree, FaultTree):
            continue
        below = {key: gate.of for key, gate in tree.gates.items()}
        for key in order(tree.top, below)[0]:
            gate = tree.gates.get(key)
            if gate is not None and not gate.of:
                message = (
                    f"port {gate.name!r} has no input: what it represents is left out, so that no "
                    f"threshold may trust p_fail of {system.top!r}"
                )
                hint = "connect it in the model, or take it out there"
                yield error("R005", message, gate.place, hint)


def _references(system: ReliabilitySystem) -> Iterator[Problem]:
    names = list(system.components)
    near = SimilarNames(names, "there are")
    for component in system.components.values():
        for below in component.below:
            if below not in system.components:
                message = f"model {component.name!r} uses {below!r}, which does not exist"
                yield error("R001", message, _place_of_use(component, below), near.hint(below))
    below_all = {name: one.below for name, one in system.components.items()}
    cycle = order(_ALL, {_ALL: names, **below_all})[1]
    if cycle:
        place = system.components[cycle[0]].place
        yield error("R012", f"models use each other in a cycle: {_shown(cycle)}", place)


def _place_of_use(component: ComponentModel, model: str) -> Place:
    """Return where a model names another one."""
    if isinstance(component.content, FaultTree):
        for event in component.content.events.values():
            if event.law is not None and event.law.model == model:
                return event.place
    return component.place


def _shown(cycle: tuple[str, ...]) -> str:
    least = min(range(len(cycle)), key=lambda i: cycle[i])
    members = [*cycle[least:], *cycle[:least]]
    return " -> ".join([*members, members[0]])


def _tree(component: ComponentModel, tree: FaultTree) -> list[Problem]:
    below = {key: gate.of for key, gate in tree.gates.items()}
    names, cycle = order(tree.top, below)
    if cycle:
        message = f"tree {component.name!r} reaches a cycle: {_shown(cycle)}"
        return [error("R012", message, tree.gates[cycle[0]].place)]
    problems: list[Problem] = []
    uses = Counter(one for key in names if key in tree.gates for one in tree.gates[key].of)
    for key in names:
        if key in tree.gates:
            problems += _gate(tree, tree.gates[key], uses)
        elif tree.events[key].law is None:
            message = f"event {tree.events[key].name!r} has no probability"
            place = tree.events[key].place
            problems.append(error("R006", message, place, _ways(in_eddi=place.path is not None)))
    unused = [key for key in (*tree.gates, *tree.events) if key not in set(names)]
    if unused:
        shown = ", ".join(unused[:8]) + (", ..." if len(unused) > 8 else "")
        message = f"tree {component.name!r} does not reach {shown}"
        problems.append(warning("R013", message, component.place))
    if has_errors(problems):
        return problems
    return problems + _diagram(component, tree)


def _ways(*, in_eddi: bool) -> str:
    if in_eddi:
        ways = "give its failure a failureRate or a failureProbDistribution, or make it a failState"
        return f'{ways} (docs/reference/reliability.md, "From an EDDI")'
    ways = "give it a rate, a scale and shape, `p`, or a model"
    return f'{ways} (docs/reference/reliability.md, "`reliability_config.yml`, written by hand")'


def _gate(tree: FaultTree, gate: Gate, uses: Counter[str]) -> Iterator[Problem]:
    name, place = gate.name, gate.place
    if not gate.of:
        yield from _empty(gate)
        return
    if gate.type == "VOTE" and gate.k is None:
        hint = 'keyValueMaps with key "k", or `k:` in YAML'
        yield error("R005", f"gate {name!r} is a vote without k", place, hint)
    elif gate.type == "VOTE" and not 1 <= (gate.k or 0) <= len(gate.of):
        yield error("R005", f"gate {name!r} requires {gate.k} of {len(gate.of)} inputs", place)
    elif gate.type == "NOT" and len(gate.of) != 1:
        yield error("R005", f"gate {name!r} is a NOT of {len(gate.of)} inputs", place)
    elif gate.type == "XOR" and len(gate.of) > 2:
        what = f"gate {name!r} is an XOR of {len(gate.of)} inputs"
        message = f"{what}, which is true for an odd number of them"
        yield warning("R013", message, place)
    elif gate.type in DYNAMIC:
        yield from _dynamic(tree, gate, uses)


def _empty(gate: Gate) -> Iterator[Problem]:
    """Refuse a gate without inputs; a port of an EDDI is reported by the reader (X017)."""
    if not gate.is_port:
        message = f"gate {gate.name!r} has no input: a gate without inputs never occurs"
        hint = "list its inputs, or take it out"
        if gate.place.path is None:
            hint = "list its inputs in `of:`, take it out, or write an event with `p: 0` instead"
        yield error("R005", message, gate.place, hint)


def _dynamic(tree: FaultTree, gate: Gate, uses: Counter[str]) -> Iterator[Problem]:
    if gate.type == "SAND":
        message = f"gate {gate.name!r} is a SAND: independent events never coincide, so it is 0"
        yield warning("R009", message, gate.place)
    elif len(gate.of) < 2:
        message = f"gate {gate.name!r} ({gate.type}) has one input only"
        yield error("R009", message, gate.place)
    for key in gate.of:
        event = tree.events.get(key)
        reason = None
        if event is None:
            reason = "is a gate"
        elif event.observed:
            reason = "is observed"
        elif event.law is not None and event.law.kind != "exponential":
            reason = "is not exponential"
        elif event.age is not None and event.age != tree.age:
            reason = "has an age of its own"
        elif uses[key] > 1:
            reason = "occurs elsewhere too"
        if reason:
            message = f"gate {gate.name!r} ({gate.type}) cannot be analysed: {key!r} {reason}"
            hint = "inputs of dynamic gates are exponential basic events of their own"
            yield error("R009", message, gate.place, hint)


def _diagram(component: ComponentModel, tree: FaultTree) -> list[Problem]:
    lowered = lower_tree(component.name, tree)
    coherent = all(gate.type in COHERENT for gate in lowered.gates)
    if tree.approximate:
        ours: Sequence[CutSet] | None = lowered.cut_sets
        if ours is None:
            return [_no_bounds(component, tree)]
    else:
        try:
            _ = lowered.diagram
        except TooLargeError as problem:
            gate = lowered.names[problem.gate - len(lowered.events)].name
            limit = lowered.limit
            message = (
                f"the diagram of tree {component.name!r} has {problem.count} nodes below gate "
                f"{gate!r}, at the limit of {limit}"
            )
            hint = "make parts share fewer events"
            if limit <= NODE_LIMIT:  # ten times more would need more memory than there is
                hint += ", or raise node_limit"
            if coherent:
                hint += ", or take bounds: `approximation: cut_sets`"
            return [error("R010", message, component.place, hint)]
        if tree.cut_sets is None or not coherent:
            return []
        try:  # the file lists them whatever the probabilities of the events are
            ours = minimal_cut_sets(lowered.diagram_knowing({}))
        except TooLargeError:
            return []
    if tree.cut_sets is None or ours is None:
        return []
    named = frozenset(frozenset(lowered.events[i].name for i in cut_set) for cut_set in ours)
    if named == tree.cut_sets:
        return []
    message = (
        f"the minimal cut sets of the file differ in tree {component.name!r}: it has "
        f"{_sets(tree.cut_sets)}, computed are {_sets(named)}"
    )
    return [warning("R016", message, component.place)]


def _no_bounds(component: ComponentModel, tree: FaultTree) -> Problem:
    name = component.name
    names, _ = order(tree.top, {key: gate.of for key, gate in tree.gates.items()})
    gates = [tree.gates[key] for key in names if key in tree.gates]
    odd = next((gate for gate in gates if gate.type in ("NOT", "XOR")), None)
    if odd is not None:
        message = f"gate {odd.name!r} of tree {name!r} is {odd.type}, so that cut sets do not bound"
        return error("R010", f"{message} it", odd.place, "leave out `approximation`")
    message = (
        f"tree {name!r} has more than {LIMIT:,} minimal cut sets, or takes too long to find them"
    )
    hint = "leave out `approximation`, raise node_limit, or make parts share fewer events"
    return error("R010", message, tree.bounds_place, hint)


def _sets(sets: frozenset[frozenset[str]]) -> str:
    shown = sorted((sorted(set_) for set_ in sets), key=lambda one: (len(one), one))
    text = " ".join("{" + ", ".join(one) + "}" for one in shown[:10])
    return f"{text} and {len(shown) - 10} more" if len(shown) > 10 else text


def _dependence(system: ReliabilitySystem) -> Iterator[Problem]:
    """Report models that enter the top's result in two places, as if they were independent."""
    below = {name: component.below for name, component in system.components.items()}
    within: dict[str, set[str]] = {}
    for name in order(system.top, below)[0]:
        reached = {name}
        for used_model in _uses(system.components[name]):
            twice = sorted(reached & within[used_model])
            if twice:
                message = (
                    f"model {name!r} uses {twice[0]!r} in several places, but treats "
                    "them as independent"
                )
                hint = "put its parts into one fault tree"
                yield error("R009", message, system.components[name].place, hint)
            reached |= within[used_model]
        within[name] = reached


def _uses(component: ComponentModel) -> Sequence[str]:
    """Return the models that a model uses, each as often as it counts."""
    if isinstance(component.content, FaultTree):
        return [event.model for event in lower_tree("", component.content).events if event.model]
    return component.uses


def _inputs(system: ReliabilitySystem) -> Iterator[Problem]:
    types: dict[str, str] = {MISSION_END: "float"} if system.mission_end else {}
    for component in used(system).components.values():
        alone = ReliabilitySystem({component.name: component}, component.name)
        # a verdict may serve several chains
        shared = "bool" if isinstance(component.content, Chain) else ""
        for input_ in inputs_of(alone):
            if types.get(input_.id, shared) != shared:
                message = f"two inputs are called {input_.id!r}: rename a model or an event"
                yield error("R001", message, component.place)
            types[input_.id] = input_.type
