"""Which values of its variables can make a condition true, or false.

A condition that claims something good must not gain from a value that also means "nothing is
known". This walk collects, for each variable, the tests that its value may pass on the path to the
claim, with the sign of everything above it: ``NOT``, the left side of ``IMPLIES``.
"""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping, Sequence

from eddi_scaffold.common.claims import Acceptance, Holds, Use
from eddi_scaffold.conditions.definition import COMPARISONS
from eddi_scaffold.program.instructions import BOOL, Operation, Program, Read

_TURNED = {"lt": "gt", "le": "ge", "gt": "lt", "ge": "le"}
_MAX_VISITS = 20_000
SIGNS: Mapping[str, tuple[bool, ...]] = {
    "not": (False,),
    "and": (True, True),
    "or": (True, True),
    "implies": (False, True),
    "time": (True,),
    "once": (True,),
    "latch": (True, False),
}
"""Operation -> for each operand, whether more of it makes more of the result."""
_NOW = ("not", "and", "or", "implies")
"""Those whose operands count at the time of the result, so that the other operands do."""
_KNOWN = ("known", "known_bool", "known_enum", "age")
"""What only asks whether something is known: reported as an acceptance."""
_SILENT = ("number", "truth", "literal", *_KNOWN)


def uses(program: Program, root: int, *, side: bool) -> dict[str, tuple[Use, ...]]:
    """Return the uses of each variable that can make a condition true, or false (``side``)."""
    uses_of: dict[str, tuple[Use, ...]] = {}
    for variable, use in _Walk(program).uses(root, side):
        uses_of[variable] = (*uses_of.get(variable, ()), use)
    return uses_of


class _Walk:
    def __init__(self, program: Program) -> None:
        self._program = program
        self._nodes = program.operations

    def uses(self, root: int, side: bool) -> Iterator[tuple[str, Use]]:
        """Walk down from a node; a shared node is visited once for each path that matters."""
        waiting: list[tuple[int, bool, tuple[tuple[str, Holds], ...]]] = [(root, side, ())]
        seen: set[tuple[object, ...]] = set()
        while waiting:
            number, sign, companions = waiting.pop()
            if len(seen) > _MAX_VISITS:
                companions = ()  # the other operands only excuse, so leaving them out is safe
            if (number, sign, companions) in seen:
                continue
            seen.add((number, sign, companions))
            test, node = self._test(number, sign), self._nodes[number]
            parts = self._parts(number, sign)
            if test is not None:
                yield test[0], Use(test[1], companions)
            elif parts != [(number, sign)]:
                tests = (self._test(part, side) for part, side in parts)
                group = (*companions, *(test for test in tests if test is not None))
                waiting += [(part, side, group) for part, side in parts]
            elif node.op in _TURNED and (counts := self._counts(node)):
                waiting += [(arg, sign == more, ()) for arg, more in counts]
            elif node.op in SIGNS:
                companions = companions if node.op in _NOW else ()
                signs = zip(node.args, SIGNS[node.op], strict=True)
                waiting += [(arg, sign == same, companions) for arg, same in signs]
            elif node.op not in _SILENT:  # every variable below, in any value
                for below in nodes_below(self._nodes, number, _SILENT):
                    if below.op == "variable":
                        names = inputs_of(self._program.reads[below.value])
                        yield from ((name, Use()) for name in names)

    def _parts(self, root: int, sign: bool) -> list[tuple[int, bool]]:
        """Return what must all hold: the operands of AND, or of OR where it shall be false."""
        parts: list[tuple[int, bool]] = []
        waiting = [(root, sign)]
        while waiting:
            number, side = waiting.pop()
            op, args = self._nodes[number].op, self._nodes[number].args
            if op == "not":
                waiting.append((args[0], not side))
            elif op == ("and" if side else "or"):
                waiting += [(arg, side) for arg in reversed(args)]
            elif op == "implies" and not side:
                waiting += [(args[1], False), (args[0], True)]
            else:
                parts.append((number, side))
        return list(dict.fromkeys(parts))

    def _test(self, number: int, sign: bool) -> tuple[str, Holds] | None:
        """Return the variable and the test of a node that tests one variable, else ``None``."""
        node = self._nodes[number]
        while node.op == "not":
            node, sign = self._nodes[node.args[0]], not sign
        variable = self._plain(node)
        if variable is not None and variable.type == BOOL:
            return variable.name, lambda value: value is sign
        op = node.op.removesuffix("_bool").removesuffix("_enum")
        if op not in COMPARISONS:
            return None
        left, right = (self._nodes[arg] for arg in node.args)
        if right.op == "variable":
            left, right, op = right, left, _TURNED.get(op, op)
        variable, limit = self._plain(left), right.value
        if variable is None or right.op not in ("number", "truth", "literal"):
            return None
        if right.op == "truth":
            limit = limit == 2
        elif right.op == "literal":
            limit = variable.literals[limit]

        def holds(value: object) -> bool:
            try:
                return COMPARISONS[op](value, limit) is sign
            except TypeError:  # a text is no number, so it is unknown: neither true nor false
                return False

        return variable.name, holds

    def _counts(self, node: Operation) -> list[tuple[int, bool]]:
        """Return what a comparison counts, and whether more of it brings the comparison about."""
        left, right = (self._nodes[arg] for arg in node.args)
        ops = ((left, right, node.op), (right, left, _TURNED[node.op]))
        return [
            (count.args[0], op in ("gt", "ge"))
            for count, limit, op in ops
            if count.op == "count" and limit.op == "number"
        ]

    def _plain(self, node: Operation) -> Read | None:
        """Return the variable that a node is, unless it is a reduction of a list."""
        variable = self._program.reads[node.value] if node.op == "variable" else None
        return None if variable is None or variable.reduction is not None else variable


def inputs_of(variable: Read) -> Sequence[str]:
    """Return the names of what a variable is read from: of a reduction, its lists."""
    if variable.reduction is None:
        return [variable.name]
    return [part.name for part in variable.reduction.inputs]


def nodes_below(
    nodes: Sequence[Operation], root: int, ends: Container[str] = ()
) -> Iterator[Operation]:
    """Yield an operation and all below it, each once; the arguments of ``ends`` are omitted."""
    waiting, seen = [root], set()
    while waiting:
        number = waiting.pop()
        if number in seen:
            continue
        seen.add(number)
        yield nodes[number]
        if nodes[number].op not in ends:
            waiting += reversed(nodes[number].args)


def accepted(program: Program, root: int) -> list[Acceptance]:
    """Return what a condition accepts of silence, each by its word in the text.

    ``KNOWN`` and ``AGE`` take silence as an argument, ``COVERAGE`` a share of the samples for all
    of them, ``ALLOW INF`` an infinite value. Where the definition of the message makes infinity a
    measurement, nothing is missing: what is missing is NaN or no message there, hence UNKNOWN.
    """
    silences: dict[Acceptance, None] = {}
    for node in nodes_below(program.operations, root):
        variable = program.reads[node.value] if node.op == "variable" else None
        coverage = node.coverage
        if variable is not None and variable.reduction is not None:
            coverage = variable.reduction.coverage
        texts: list[tuple[str, str, float | None]] = []
        if node.op in _KNOWN:
            texts.append((node.op.partition("_")[0].upper(), "silence itself as an argument", None))
        elif coverage is not None and coverage < 1:
            seconds = node.window / 1e9 if node.window else None
            of = "elements" if seconds is None else "samples"
            share = f"{coverage:.0%} of the {of} for all of them"
            texts.append((f"COVERAGE {coverage:g}", share, seconds))
        if variable is not None and variable.infinite and not variable.defined:
            texts.append(("ALLOW INF", "an infinite value", None))
        for word, accepts, seconds in texts:
            lasts = "as its text states" if seconds is None else f"for {seconds:g} s"
            silences[Acceptance(word, accepts, lasts, seconds, at=node.at)] = None
    return list(silences)
