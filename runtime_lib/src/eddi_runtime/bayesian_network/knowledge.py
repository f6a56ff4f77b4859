"""What is known of the nodes that inputs feed, and what is accepted in place of it."""

from __future__ import annotations

from operator import eq
from typing import Dict, Iterable, List, Mapping, NamedTuple, Optional, Sequence, Set, Tuple, Union

from ..inputs import InputSpec
from .bounds import Open
from .direct import DirectReader
from .engine import Engine
from .methods import Answer
from .readers import Discretiser

NO_ANSWER = Answer()


class Source(NamedTuple):
    """A declared way from an input to a node."""

    node: int
    spec: InputSpec
    reader: Union[Discretiser, DirectReader]


class Step:
    """What the last step saw.

    Attributes:
        raw: the value of each source.
        states: of each observable node.
        weights: likelihoods, by position.
        answer: of the methods.
        inconsistent: the evidence has probability zero.
        problem: what kept the step from being done.
    """

    __slots__ = ("answer", "inconsistent", "problem", "raw", "states", "weights")

    def __init__(self, missing: Sequence[int]) -> None:
        self.raw: Sequence[object] = ()
        self.states = list(missing)
        self.weights: Dict[int, List[float]] = {}
        self.answer = NO_ANSWER
        self.inconsistent = False
        self.problem = ""


class Facts(NamedTuple):
    """What is known about the inputs of a step.

    Attributes:
        valid: all of them are known, and so are the states of their nodes.
        unknown_inputs: inputs without a usable value, whatever is accepted in their place; the
            node where only a method observes it.
        undecided: node -> states that it may be in, when there are several; the posterior takes the
            first.
        accepted: ``input: key`` for each key of the configuration that was needed.
    """

    valid: bool
    unknown_inputs: Tuple[str, ...]
    undecided: Mapping[str, Tuple[str, ...]]
    accepted: Tuple[str, ...]


class _Place(NamedTuple):
    """An observable node that is an input.

    Attributes:
        position: among the observable nodes.
        node: its number.
        states: numbers of its states.
        number: of its source, -1 for none.
        source: None when only a method observes it.
    """

    position: int
    node: int
    states: Tuple[int, ...]
    number: int
    source: Optional[Source]


class Knowledge:
    """The nodes that are inputs: those that are observed in one step or another.

    Args:
        sources: declared ways from inputs to nodes.
        nodes: what else is observed.
    """

    def __init__(self, sources: Sequence[Source], nodes: Iterable[int]) -> None:
        self._sources = sources
        self._nodes: Set[int] = {*nodes, *(one.node for one in sources)}
        self._doubtful = [one.reader for one in sources if one.reader.doubtful]
        self._places: List[_Place] = []
        self._missing: Tuple[int, ...] = ()

    def prepare(self, engine: Engine) -> None:
        """Take over the engine: the numbers of the nodes."""
        self._engine, self._missing = engine, engine.missing
        numbers = {one.node: k for k, one in enumerate(self._sources)}
        self._places = []
        for position, node in enumerate(engine.observable):
            if node in self._nodes:
                number = numbers.get(node, -1)
                source = self._sources[number] if number >= 0 else None
                states = tuple(range(engine.missing[position]))
                self._places.append(_Place(position, node, states, number, source))

    def opened(
        self, states: Sequence[int], weights: Mapping[int, object], answer: Answer
    ) -> List[Open]:
        """Return the nodes whose states are not known, where that is not accepted."""
        doubt = self._doubtful and any(reader.possible for reader in self._doubtful)
        if not doubt and True not in map(eq, states, self._missing):
            return []
        found: List[Open] = []
        for position, node, all_states, _, source in self._places:
            by_method = node in answer.findings or node in answer.problems
            reader = None if source is None or by_method else source.reader
            if states[position] == len(all_states):
                accepted = reader is not None and reader.prior_accepted
                if position not in weights and not accepted:
                    found.append((position, all_states))
            elif reader is not None and reader.possible:
                found.append((position, tuple(reader.possible)))
        return found

    def facts(self, step: Step) -> Facts:
        """Return what was known in a step."""
        unknown: List[str] = []
        accepted: List[str] = []
        undecided: Dict[str, Tuple[str, ...]] = {}
        nodes = self._engine.nodes
        for place in self._places:
            if place.node in step.answer.findings:
                continue
            source, node = place.source, nodes[place.node]
            if source is None or place.node in step.answer.problems:
                unknown.append(node.id)
                continue
            raw = step.raw[place.number] if place.number < len(step.raw) else None
            known, key = _judged(source, raw, step, place.position)
            if not known:
                unknown.append(source.spec.id)
            if key:
                accepted.append(f"{source.spec.id}: {key}")
            if source.reader.possible:
                texts = node.states
                taken = step.states[place.position]
                others = [one for one in source.reader.possible if one != taken]
                undecided[node.id] = tuple(texts[one] for one in (taken, *others))
        failed = step.inconsistent or step.problem or step.answer.problems
        valid = not (unknown or undecided or failed)
        return Facts(valid, _once(unknown), undecided, _once(accepted))


def _judged(source: Source, raw: object, step: Step, position: int) -> Tuple[bool, str]:
    """Return whether a value is known, and which key was needed for it."""
    reading = step.weights.get(position, step.states[position])
    try:
        return source.reader.knows(raw), source.reader.accepted(raw, reading)
    except Exception:  # noqa: BLE001 - a hostile object
        return False, ""


def _once(names: Iterable[str]) -> Tuple[str, ...]:
    return tuple(dict.fromkeys(names))
