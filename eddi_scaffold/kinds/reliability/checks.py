"""What is wrong with a system that was read: before anything is computed of it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

from eddi_scaffold.common.problems import Place, Problem, SimilarNames, has_errors, problem
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
        yield problem("R007.initial", place, name=name, actual=found)
        broken = True
    if not chain.fail:
        yield problem("R007.no_fail_state", place, name=name)
        broken = True
    failed = next((state for state in chain.initial if state in chain.fail), None)
    if failed is not None and len(chain.initial) == 1:
        yield problem("R007.starts_failed", place, state=failed)
        broken = True
    if len(chain.states) > MAX_STATES:
        yield problem("R002.states", place, name=name, states=len(chain.states), limit=MAX_STATES)
        broken = True
    for arc in chain.arcs:
        if arc.rate > _LARGEST_RATE:
            yield problem(
                "R002.rate",
                arc.place,
                rate=arc.rate,
                source=arc.source,
                target=arc.target,
                name=name,
                limit=_LARGEST_RATE,
            )
            broken = True
    if not broken:
        yield from _reach(name, chain, place)


def _reach(name: str, chain: Chain, place: Place) -> Iterator[Problem]:
    for state in chain.fail:
        if any(arc.source == state and arc.rate > 0.0 for arc in chain.arcs):
            yield problem("R013.after_failure", place, state=state, name=name)
    lowered = chain_of(chain)
    reached = chains.reached(lowered)
    lost = [state for number, state in enumerate(chain.states) if number not in reached]
    if lost:
        shown = ", ".join(lost[:8]) + (", ..." if len(lost) > 8 else "")
        yield problem("R013.unreached", place, name=name, states=shown)
    if lowered.initial not in chains.reaching(lowered, lowered.fail):
        yield problem("R013.cannot_fail", place, name=name, initial=chain.initial[0])
    elif lowered.initial not in chains.certain(lowered):
        yield problem("R013.may_stay", place, name=name)
    count = len(chain.states)
    if count > _LARGE:
        size = 8e-6 * count**2
        yield problem("R013.large", place, name=name, states=count, size=size)


_ALL = "\0"
"""Stands above all models; no model is called so."""


def check_system(system: ReliabilitySystem) -> list[Problem]:
    """Return all problems of the models that the top uses (R001, R005 to R013)."""
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
                yield problem("R005.port", gate.place, gate=gate.name, top=system.top)


def _references(system: ReliabilitySystem) -> Iterator[Problem]:
    names = list(system.components)
    near = SimilarNames(names, "there are")
    for component in system.components.values():
        for below in component.below:
            if below not in system.components:
                yield problem(
                    "R001.unknown_model",
                    _place_of_use(component, below),
                    hint=near.hint(below),
                    model=component.name,
                    used=below,
                )
    below_all = {name: one.below for name, one in system.components.items()}
    cycle = order(_ALL, {_ALL: names, **below_all})[1]
    if cycle:
        place = system.components[cycle[0]].place
        yield problem("R012.models", place, cycle=_shown(cycle))


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
        return [
            problem(
                "R012.tree", tree.gates[cycle[0]].place, tree=component.name, cycle=_shown(cycle)
            )
        ]
    problems: list[Problem] = []
    uses = Counter(one for key in names if key in tree.gates for one in tree.gates[key].of)
    for key in names:
        if key in tree.gates:
            problems += _gate(tree, tree.gates[key], uses)
        elif tree.events[key].law is None:
            place = tree.events[key].place
            problems.append(
                problem(
                    "R002.none",
                    place,
                    hint=_ways(in_eddi=place.path is not None),
                    event=tree.events[key].name,
                )
            )
    unused = [key for key in (*tree.gates, *tree.events) if key not in set(names)]
    if unused:
        shown = ", ".join(unused[:8]) + (", ..." if len(unused) > 8 else "")
        problems.append(problem("R013.unused", component.place, tree=component.name, parts=shown))
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
        yield problem("R005.vote", place, name=name)
    elif gate.type == "VOTE" and not 1 <= (gate.k or 0) <= len(gate.of):
        yield problem("R005.vote_inputs", place, name=name, required=gate.k, number=len(gate.of))
    elif gate.type == "NOT" and len(gate.of) != 1:
        yield problem("R005.not_inputs", place, name=name, number=len(gate.of))
    elif gate.type == "XOR" and len(gate.of) > 2:
        what = f"gate {name!r} is an XOR of {len(gate.of)} inputs"
        yield problem("R013.xor", place, subject=what)
    elif gate.type in DYNAMIC:
        yield from _dynamic(tree, gate, uses)


def _empty(gate: Gate) -> Iterator[Problem]:
    """Refuse a gate without inputs; a port of an EDDI is reported by the reader (X014)."""
    if not gate.is_port:
        hint = "list its inputs, or take it out"
        if gate.place.path is None:
            hint = "list its inputs in `of:`, take it out, or write an event with `p: 0` instead"
        yield problem("R005.no_input", gate.place, hint=hint, gate=gate.name)


def _dynamic(tree: FaultTree, gate: Gate, uses: Counter[str]) -> Iterator[Problem]:
    if gate.type == "SAND":
        yield problem("R009.sand", gate.place, gate=gate.name)
    elif len(gate.of) < 2:
        yield problem("R009.one_input", gate.place, gate=gate.name, type=gate.type)
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
            yield problem(
                "R009.dynamic", gate.place, gate=gate.name, type=gate.type, key=key, reason=reason
            )


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
        except TooLargeError as failure:
            gate = lowered.names[failure.gate - len(lowered.events)].name
            limit = lowered.limit
            hint = "make parts share fewer events"
            if limit <= NODE_LIMIT:  # ten times more would need more memory than there is
                hint += ", or raise node_limit"
            if coherent:
                hint += ", or take bounds: `approximation: cut_sets`"
            return [
                problem(
                    "R010.diagram",
                    component.place,
                    hint=hint,
                    tree=component.name,
                    nodes=failure.count,
                    gate=gate,
                    limit=limit,
                )
            ]
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
    return [
        problem(
            "R013.cut_sets_differ",
            component.place,
            tree=component.name,
            actual=_sets(tree.cut_sets),
            computed=_sets(named),
        )
    ]


def _no_bounds(component: ComponentModel, tree: FaultTree) -> Problem:
    name = component.name
    names, _ = order(tree.top, {key: gate.of for key, gate in tree.gates.items()})
    gates = [tree.gates[key] for key in names if key in tree.gates]
    odd = next((gate for gate in gates if gate.type in ("NOT", "XOR")), None)
    if odd is not None:
        message = f"gate {odd.name!r} of tree {name!r} is {odd.type}, so that cut sets do not bound"
        return problem("R010.approximation", odd.place, sentence=message)
    return problem("R010.cut_sets", tree.bounds_place, name=name, limit=LIMIT)


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
                yield problem(
                    "R009.shared", system.components[name].place, model=name, used=twice[0]
                )
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
                yield problem("R001.same_input", component.place, input=input_.id)
            types[input_.id] = input_.type
