"""The program of a ConSert: judge the evidence, filter it, then one operation for each gate."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from eddi_scaffold.compiling.consert.graph import Graph, build_graph
from eddi_scaffold.compiling.consert.model import (
    BinaryLeaf,
    CategoricalLeaf,
    ConSertData,
    Leaf,
    NumericLeaf,
    read_consert,
)
from eddi_scaffold.compiling.document import InputData, ModelError, ModelFile
from eddi_scaffold.compiling.expressions.inlining import inlined
from eddi_scaffold.compiling.program.instructions import (
    BOOL,
    MAX_NS,
    NUMBER,
    TEXT,
    Operation,
    Program,
    Read,
    Result,
)
from eddi_scaffold.compiling.text import comment


class Compiled(NamedTuple):
    """A ConSert that was read, its elements in order, and its program.

    Attributes:
        data: the ConSert.
        graph: its elements.
        program: reads its inputs.
        elements: operation -> number of the element in the graph.
    """

    data: ConSertData
    graph: Graph
    program: Program
    elements: dict[int, int]


def program_of(model_file: ModelFile) -> Program:
    """Return the program of a ConSert, with the expressions that give its inputs.

    Raises:
        ModelError: the model is wrong.
    """
    return inlined(compiled(model_file).program, model_file.inputs)


def compiled(model_file: ModelFile, *, allow_unsupported: bool = False) -> Compiled:
    """Return the ConSert of a model file and its program.

    Args:
        model_file: the model.
        allow_unsupported: take guarantees without support and gates without input as the
            constants that they are in SESAME's first tool; for tests of the evaluation only.

    Raises:
        ModelError: the model is wrong, or has a constant that no author meant.
    """
    data = read_consert(model_file)
    graph = build_graph(data)
    if graph.unsupported and not allow_unsupported:
        listed = ", ".join(map(repr, graph.unsupported))
        raise ModelError("", f"constant without being meant as default: {listed}")
    return Compiled(data, graph, *_program(data, graph, model_file.inputs))


def _program(
    data: ConSertData, graph: Graph, inputs: Sequence[InputData]
) -> tuple[Program, dict[int, int]]:
    operations: list[Operation] = []
    elements: dict[int, int] = {}
    held: list[int] = []  # element -> the operation that has its value, -1 for none

    def add(one: Operation) -> int:
        operations.append(one)
        return len(operations) - 1

    def about(number: int) -> str:
        name = graph.names[number]
        path = data.paths.get(name, "")
        return comment(f"{name}: {path}" if path else name)

    for k, leaf in enumerate(data.leaves):
        type_, op, value = _judged(leaf)
        raw = add(Operation("variable", (), type_, k, leaf.id))
        held.append(add(Operation(op, (raw,), BOOL, value, about(k))))
        elements[held[k]] = k
    if data.filter is not None:
        for k, judged in enumerate(held):
            what, steps = data.filter
            held[k] = add(Operation(what, (judged,), BOOL, steps, f"{what} {about(k)}"))
            elements[held[k]] = k
    for k, (is_and, sources) in enumerate(graph.nodes, graph.leaves):
        args = tuple(held[source] for source in sources)
        if k not in graph.needed:
            held.append(-1)
        elif not sources:
            held.append(add(Operation("truth", (), BOOL, 2 if is_and else 0, about(k))))
        elif len(sources) == 1:
            held.append(args[0])
        else:
            words = f"{'And' if is_and else 'Or'} {about(k)}"
            held.append(add(Operation("and" if is_and else "or", args, BOOL, None, words)))
            elements[held[k]] = k
    results = (
        Result(guarantee.published, held[k], about=about(k))
        for guarantee, k in zip(data.guarantees, graph.guarantees, strict=True)
    )
    reads = map(_read, data.leaves, inputs)
    return Program(0, tuple(reads), tuple(operations), tuple(results)), elements


def _read(leaf: Leaf, spec: InputData) -> Read:
    age = spec.max_age if isinstance(spec.max_age, int | float) else None
    timeout = None if age is None else round(min(age * 1e9, MAX_NS))
    type_ = _judged(leaf)[0]
    covered = ""
    if isinstance(leaf, CategoricalLeaf):
        covered = f"good: {' or '.join(leaf.covered)}"
    elif isinstance(leaf, NumericLeaf):
        covered = f"good: {leaf.text}"
    elif not leaf.good:
        covered = "good: false"
    return Read(
        leaf.id,
        type_,
        timeout=timeout,
        infinite=type_ == NUMBER,
        stamped=timeout is not None,
        about=comment(covered),
    )


def _judged(leaf: Leaf) -> tuple[str, str, object]:
    """Return the type of what is read, the operation that judges it, and what is covered."""
    if isinstance(leaf, BinaryLeaf):
        return BOOL, "is_true" if leaf.good else "is_false", None
    if isinstance(leaf, CategoricalLeaf):
        return TEXT, "is_covered", leaf.covered
    return NUMBER, "is_within", leaf.ranges
