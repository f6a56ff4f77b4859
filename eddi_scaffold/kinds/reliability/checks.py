"""What is wrong with a system that was read: before anything is computed of it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

from eddi_scaffold.common.problems import Place, Problem, SimilarNames, has_errors, problem
from eddi_scaffold.kinds.reliability import chains
from eddi_scaffold.kinds.reliability.decision_diagram import NODE_LIMIT
from eddi_scaffold.kinds.reliability.fault_tree import COHERENT, CUT_SETS, TooLargeError, order
from eddi_scaffold.kinds.reliability.lowering import chain_of, lower_tree
from eddi_scaffold.kinds.reliability.system import (
    DYNAMIC,
    MISSION_END,
    Chain,
    ComponentModel,
    FaultTree,
    Gate,
    ReliabilitySystem,
)

MAX_STATES = 2000
_LARGEST_RATE = 1e12
_ALL = "\0"  # Stands above all models; no model is called so


def check_system(system: ReliabilitySystem) -> list[Problem]:
    """Return all problems of the models that the top uses (R001, R002, R005 to R013)."""
    problems: list[Problem] = []
    for check in (_references, _contents, _combination):
        problems += [] if has_errors(problems) else check(system)
    return problems


def _references(system: ReliabilitySystem) -> Iterator[Problem]:
    names = list(system.components)
    similar = SimilarNames(names, "there are")
    for name, component in system.components.items():
        tree = component.content
        events = [*tree.events.values()] if isinstance(tree, FaultTree) else []
        for used in component.below:
            if used not in system.components:
                users = (event.place for event in events if event.law and event.law.model == used)
                place, hint = next(users, component.place), similar.hint(used)
                yield problem("R001.unknown_model", place, hint=hint, model=name, used=used)
    below = {name: component.below for name, component in system.components.items()}
    cycle = order(_ALL, {_ALL: names, **below})[1]
    if cycle:
        place = system.components[cycle[0]].place
        yield problem("R012.models", place, cycle=" -> ".join([*cycle, cycle[0]]))


def _contents(system: ReliabilitySystem) -> Iterator[Problem]:
    for component in system.without_unused().components.values():
        if isinstance(component.content, Chain):
            yield from _chain(component.name, component.content, component.place)
        elif isinstance(component.content, FaultTree):
            problems = list(_parts_of_tree(component, component.content))
            yield from problems
            if not has_errors(problems):
                yield from _size(component, component.content)


def _chain(name: str, chain: Chain, place: Place) -> Iterator[Problem]:
    count, initial, errors = len(chain.states), chain.initial, []
    if len(initial) != 1:
        actual = ", ".join(initial) or "none"
        errors.append(problem("R007.initial", place, name=name, actual=actual))
    elif initial[0] in chain.fail:
        errors.append(problem("R007.starts_failed", place, state=initial[0]))
    if not chain.fail:
        errors.append(problem("R007.no_fail_state", place, name=name))
    if count > MAX_STATES:
        errors.append(problem("R002.states", place, name=name, states=count, limit=MAX_STATES))
    for arc in chain.arcs:
        if arc.rate > _LARGEST_RATE:
            fields = {"source": arc.source, "target": arc.target, "name": name}
            fault = problem("R002.rate", arc.place, rate=arc.rate, limit=_LARGEST_RATE, **fields)
            errors.append(fault)
    yield from errors
    if errors:
        return
    for state in chain.fail:
        if any(arc.source == state and arc.rate > 0.0 for arc in chain.arcs):
            yield problem("R013.after_failure", place, state=state, name=name)
    lowered = chain_of(chain)
    reached = chains.reached(lowered)
    lost = [state for number, state in enumerate(chain.states) if number not in reached]
    if lost:
        yield problem("R013.unreached", place, name=name, states=_first_few(lost))
    if lowered.initial not in chains.reaching(lowered, lowered.fail):
        yield problem("R013.cannot_fail", place, name=name, initial=initial[0])
    elif lowered.initial not in chains.certain(lowered):
        yield problem("R013.may_stay", place, name=name)


def _first_few(names: Sequence[str]) -> str:
    return ", ".join(names[:8]) + (", ..." if len(names) > 8 else "")


def _parts_of_tree(component: ComponentModel, tree: FaultTree) -> Iterator[Problem]:
    names, cycle = tree.reached()
    if cycle:
        place = tree.gates[cycle[0]].place
        yield problem(
            "R012.tree", place, tree=component.name, cycle=" -> ".join([*cycle, cycle[0]])
        )
        return
    uses = Counter(below for key in names if key in tree.gates for below in tree.gates[key].of)
    for key in names:
        if key in tree.gates:
            yield from _gate(tree, tree.gates[key], uses)
        elif tree.events[key].law is None:
            place = tree.events[key].place
            case = "R002.none" if place.path is None else "R002.none_in_eddi"
            yield problem(case, place, event=tree.events[key].name)
    reached = set(names)
    unused = [key for key in (*tree.gates, *tree.events) if key not in reached]
    if unused:
        parts = _first_few(unused)
        yield problem("R013.unused", component.place, tree=component.name, parts=parts)


def _gate(tree: FaultTree, gate: Gate, uses: Counter[str]) -> Iterator[Problem]:
    name, place, number = gate.name, gate.place, len(gate.of)
    if not gate.of:
        if not gate.is_port:  # a port of an EDDI is reported by the reader (X014)
            case = "R005.no_input" if place.path is None else "R005.no_input_in_eddi"
            yield problem(case, place, gate=name)
    elif gate.type == "VOTE" and gate.k is None:
        yield problem("R005.vote", place, name=name)
    elif gate.type == "VOTE" and not 1 <= (gate.k or 0) <= number:
        yield problem("R005.vote_inputs", place, name=name, required=gate.k, number=number)
    elif gate.type == "NOT" and number != 1:
        yield problem("R005.not_inputs", place, name=name, number=number)
    elif gate.type == "XOR" and number > 2:
        yield problem("R013.xor", place, gate=name, number=number)
    elif gate.type in DYNAMIC:
        if gate.type == "SAND":
            yield problem("R009.sand", place, gate=name)
        elif number < 2:
            yield problem("R009.one_input", place, gate=name, type=gate.type)
        for key in gate.of:
            event = tree.events.get(key)
            law = event.law if event else None
            reasons = {
                "is a gate": event is None,
                "is observed": event and event.observed,
                "is not exponential": law and law.kind != "exponential",
                "has an age of its own": event and event.age not in (None, tree.age),
                "occurs elsewhere too": uses[key] > 1,
            }
            reason = next((reason for reason, holds in reasons.items() if holds), None)
            if reason:
                fields = {"gate": name, "type": gate.type, "key": key}
                yield problem("R009.dynamic", place, reason=reason, **fields)


def _size(component: ComponentModel, tree: FaultTree) -> Iterator[Problem]:
    name, place = component.name, component.place
    lowered = lower_tree(name, tree)
    if tree.approximate and lowered.cut_sets is None:
        gate = next((gate for gate in tree.used_gates() if gate.type in ("NOT", "XOR")), None)
        if gate is None:
            yield problem("R010.cut_sets", tree.bounds_place, name=name, limit=CUT_SETS)
        else:
            fields = {"gate": gate.name, "tree": name, "type": gate.type}
            yield problem("R010.approximation", gate.place, **fields)
        return
    try:
        lowered.diagram  # noqa: B018 - it is built
    except TooLargeError:
        hint = "make parts share fewer events"
        if lowered.limit <= NODE_LIMIT:  # ten times more would need more memory than there is
            hint += ", or raise node_limit"
        if all(gate.type in COHERENT for gate in lowered.gates):
            hint += ", or take bounds: `approximation: cut_sets`"
        yield problem("R010.diagram", place, hint=hint, tree=name, limit=lowered.limit)
        return


def _combination(system: ReliabilitySystem) -> Iterator[Problem]:
    used = system.without_unused().components.values()
    for tree in (component.content for component in used if system.thresholds):
        # evidence from trees that leave out unconnected ports
        for gate in tree.used_gates() if isinstance(tree, FaultTree) else ():
            if not gate.of:
                yield problem("R005.port", gate.place, gate=gate.name, top=system.top)
    yield from _dependence(system)
    types: dict[str, str] = {MISSION_END: "float"} if system.mission_end else {}
    for component in used:
        # a verdict may serve several chains
        shared = "bool" if isinstance(component.content, Chain) else ""
        for input_ in component.inputs():
            if types.get(input_.id, shared) != shared:
                yield problem("R001.same_input", component.place, input=input_.id)
            types[input_.id] = input_.type


def _dependence(system: ReliabilitySystem) -> Iterator[Problem]:
    """Report models that enter the top's result in two places, as if they were independent."""
    within: dict[str, set[str]] = {}
    for model in system.used_models():
        used: Sequence[str] = model.uses
        if isinstance(model.content, FaultTree):  # each as often as it counts
            used = [event.model for event in lower_tree("", model.content).events if event.model]
        reached = {model.name}
        for name in used:
            twice = sorted(reached & within[name])
            if twice:
                yield problem("R009.shared", model.place, model=model.name, used=twice[0])
            reached |= within[name]
        within[model.name] = reached
