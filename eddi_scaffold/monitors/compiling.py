"""From a bound model to the text of ``compiled.py``, and to the facts that others read of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from eddi_runtime import ModelError as NotRunning
from eddi_runtime.history import EDDIInputBase

from eddi_scaffold.common.claims import Acceptance, Claim
from eddi_scaffold.common.problems import EddiError, Place, problem
from eddi_scaffold.conditions.uses import inputs_of
from eddi_scaffold.kinds import Model
from eddi_scaffold.monitors.digest import digest_of
from eddi_scaffold.monitors.facts import InputFacts, MonitorFacts
from eddi_scaffold.program.input_expressions import BoundInput, expression_lines
from eddi_scaffold.program.instructions import Program
from eddi_scaffold.program.monitor_text import Declaration, module_text
from eddi_scaffold.program.python_text import comment
from eddi_scaffold.program.running import module_of


@dataclass(frozen=True)
class CompiledModule:
    """What a package, or a program that plays it, runs."""

    text: str  # of `compiled.py` where the runtime is installed, without the last line end
    # name -> content of the files that must lie next to it
    tables: Mapping[str, bytes] = field(default_factory=dict)
    program: Program | None = None  # its step, of a kind that is compiled to one

    def monitor(self, model_id: str) -> Any:
        """Return a new monitor, as the package would load it; hand-written code is not in it."""
        return module_of(f"{self.text}\n", model_id, self.tables.__getitem__).Monitor()


def compile_monitor(
    model: Model,
    inputs: Sequence[BoundInput],
    accepted: Sequence[Acceptance],
    frequency: float,
    place: Place,
) -> tuple[CompiledModule, MonitorFacts]:
    """Compile a configured model, run the result once, and return it with its facts.

    Raises:
        EddiError: the runtime refuses the monitor (K028).
    """
    source, path = model.source, model.place.path
    digest = digest_of(model.kind, model, tuple(inputs))
    compiled = model.compile(Declaration(model.name, digest, tuple(inputs)))
    compiled = replace(compiled, lines=[*expression_lines(inputs), *compiled.lines])
    origin = f"{comment(source.file_name)} {comment(path or '')}"
    text = module_text(model.kind, compiled, model.name, origin)
    module = CompiledModule(text.removesuffix("\n"), compiled.tables, compiled.program)
    try:
        EDDIInputBase().bind(module.monitor(model.name).inputs)
    except NotRunning as refused:  # what will run it has the last word
        raise EddiError(problem("K028.refused", place, reason=refused.reason)) from None
    of_model = model.acceptances(inputs, frequency)
    hold_s = max((acceptance.seconds or 0.0 for acceptance in of_model), default=0.0)
    result = Claim("", frozenset(input_.id for input_ in inputs), hold_s)
    timeouts, input_facts = model.input_timeouts(), []
    for input_ in inputs:
        limits = [timeouts[input_.id]] if input_.id in timeouts else []
        for part in input_.expression["parts"] if input_.expression else ():
            of_reads = [read.timeout for read in part["program"].reads]
            limits += [max(of_reads) / 1e9] if of_reads and None not in of_reads else []
        input_facts.append(
            InputFacts(
                input_.id,
                input_.attribute,
                input_.requires,
                input_.max_age,
                min(limits, default=None),
                input_.every_message,
                names_read(input_.expression),
            )
        )
    facts = MonitorFacts(
        model.kind,
        model.name,
        digest,
        source.file_name,
        source.sha256,
        tuple(input_facts),
        path,
        tuple(model.claims(inputs, frequency)) or (result,),  # one that names no claims has one
        (*of_model, *accepted),
        tuple(model.elements()),
        dict(model.links) or None,
    )
    return module, facts


def names_read(expression: Mapping[str, Any] | None) -> tuple[str, ...] | None:
    """Return the names of fields and inputs that an expression reads; ``None`` for none."""
    if expression is None:
        return None
    reads = (read for part in expression["parts"] for read in part["program"].reads)
    return tuple(dict.fromkeys(name for read in reads for name in inputs_of(read)))
