"""From a bound model to the text of ``compiled.py``, and to the facts that others read of it."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import MISSING, dataclass, field, fields, is_dataclass, replace
from enum import Enum
from fractions import Fraction
from functools import cache, partial
from typing import Any

import pydantic_core
from eddi_runtime import ModelError as NotRunning
from eddi_runtime.history import EDDIInputBase
from pydantic import TypeAdapter

from eddi_scaffold.common.claims import Acceptance, Claim, Element, held
from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import EddiError, Place, Problem, problem
from eddi_scaffold.conditions.lags import Lag, lags
from eddi_scaffold.conditions.uses import inputs_of
from eddi_scaffold.eddi_xml.links import Linked
from eddi_scaffold.kinds import Model, ModelInput
from eddi_scaffold.program.input_expressions import BoundInput, expression_lines
from eddi_scaffold.program.instructions import Program
from eddi_scaffold.program.monitor_text import Declaration, module_text
from eddi_scaffold.program.python_text import comment
from eddi_scaffold.program.running import module_of

FORMAT = 1
_NEXT = ",\n"


@dataclass(frozen=True)
class InputFacts:
    """One input of a monitor."""

    id: str
    attribute: str  # its name in `EDDIInput`
    requires: tuple[str, ...] = ()  # ids of the simulator outputs that it is made of
    max_age: float | str | None = None  # as `InputBinding` has it
    # seconds after which its kind or its expression takes it as unknown
    timeout_s: float | None = None
    every_message: bool = False  # no message is skipped
    reads: tuple[str, ...] | None = None  # names that its expression reads; `None` without one


@dataclass(frozen=True)
class MonitorFacts:
    """Content of the answer ``facts``."""

    kind: str
    id: str
    digest: str  # of all that decides what the monitor computes; robots compare it
    file: str
    file_sha256: str
    inputs: tuple[InputFacts, ...]  # in the order of the configuration
    path: str | None = None  # EMF fragment path of the model in an EDDI
    claims: tuple[Claim, ...] = ()
    acceptances: tuple[Acceptance, ...] = ()  # what it accepts in place of what is not known
    elements: tuple[Element, ...] = ()  # in the order of the model
    # path of an element -> what is linked with it in the EDDI
    links: dict[str, Linked] | None = None
    format: int = FORMAT

    def claims_on(self, part: str | None) -> list[Claim]:
        """Return the claims on a topic that carries one of them, or all."""
        return [claim for claim in self.claims if part in (None, claim.id)]

    def to_json(self) -> str:
        """Return the text of the answer, a line for each part; what is the default is left out."""
        model: dict[str, Any] = {}
        lines = []
        text = partial(json.dumps, default=sorted)  # of what is a set
        for name, value in _adapter().dump_python(self, exclude_defaults=True).items():
            if isinstance(value, tuple):
                lines.append(f'"{name}": [{_NEXT.join(map(text, value))}]')
            elif isinstance(value, dict):
                rows = (f"{text(key)}: {text(of)}" for key, of in value.items())
                lines.append(f'"{name}": {{{_NEXT.join(rows)}}}')
            else:
                model[name] = value
        about = f'"model": {json.dumps({**model, "format": self.format})}'
        return f"{{{_NEXT.join([about, *lines])}}}"


def from_json(text: object) -> MonitorFacts:
    """Return the facts of a package (ValueError: the text is damaged, or of another format)."""
    data = pydantic_core.from_json(text) if isinstance(text, str) and text else None
    if not isinstance(data, dict) or not isinstance(data.get("model"), dict):
        raise ValueError("there are no facts of the monitor")  # noqa: TRY004 - damage, no misuse
    facts = _adapter().validate_python({**data.pop("model"), **data})
    if facts.format != FORMAT:
        raise ValueError(f"facts of the format {facts.format}, only {FORMAT} is known")
    return facts


_adapter = cache(lambda: TypeAdapter(MonitorFacts))


_FOR_PEOPLE = {"about", "at", "description"}  # Fields that nothing computes with


def digest_of(*parts: object) -> str:
    """Return the SHA-256 of values: id, kind, typed model, options and bound inputs of a monitor.

    It is not over the lines that are compiled of them. Places, files, callables and descriptions
    are left out, and so are fields with ``compare=False`` and those with their default value. So a
    release that adds a field, or compiles to other lines, gives the same digest; one that renames a
    field or class of a typed model does not.

    Raises:
        TypeError: a value has no text.
    """
    return hashlib.sha256(_text(parts).encode()).hexdigest()


def _text(value: Any) -> str:
    """Return a text that differs for values that differ; empty for what decides nothing."""
    if hasattr(value, "dtype"):  # of numpy, which is not imported for it
        if value.shape:
            return f"array({value.shape}, {value.dtype.str}, {_text(value.tobytes())})"
        value = value.item()
    if isinstance(value, Enum):
        return f"{type(value).__name__}.{value.name}"
    if isinstance(value, str):
        return json.dumps(value)
    if value is None or isinstance(value, bool | int | float | Fraction):
        return repr(value)
    if isinstance(value, bytes):
        return f"bytes({hashlib.sha256(value).hexdigest()})"
    if isinstance(value, Place | Source | Problem) or callable(value):
        return ""
    if is_dataclass(value) or hasattr(value, "_fields"):
        texts = [
            (name, _text(getattr(value, name)), usual) for name, usual in _fields(value.__class__)
        ]
        decisive = (f"{name}={text}" for name, text, usual in texts if text not in ("", usual))
        return f"{type(value).__name__}({', '.join(decisive)})"
    if isinstance(value, Mapping):
        rows = value.items()  # the order is that of every output
        return f"{{{', '.join(f'{_text(key)}: {_text(item)}' for key, item in rows)}}}"
    if isinstance(value, AbstractSet):
        return f"{{{', '.join(sorted(map(_text, value)))}}}"
    if isinstance(value, list | tuple):
        if {*map(type, value)} == {float}:  # a table of a network has up to 262,144
            return repr(tuple(value))
        return f"({', '.join(map(_text, value))})"
    raise TypeError(f"a model has a value of the type {type(value).__name__}")


@cache
def _fields(type_: Any) -> Sequence[tuple[str, str]]:
    """Return the fields that decide, by name, each with the text of its default."""
    if is_dataclass(type_):
        usual = {
            of.name: of.default if of.default_factory is MISSING else of.default_factory()
            for of in fields(type_)
            if of.compare
        }
    else:
        usual = {name: type_._field_defaults.get(name, MISSING) for name in type_._fields}
    return [
        (name, "" if default is MISSING else _text(default))
        for name, default in sorted(usual.items(), key=lambda item: item[0])
        if name not in _FOR_PEOPLE
    ]


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
    """Compile a configured model and run it once (EddiError K028: it cannot); add its facts."""
    source, path = model.source, model.place.path
    digest = digest_of(model.kind, model, tuple(inputs))
    compiled = model.compile(Declaration(model.name, digest, tuple(inputs)))
    compiled = replace(compiled, lines=[*expression_lines(inputs), *compiled.lines])
    origin = f" from {comment(source.file_name)} {comment(path or '')}".rstrip()
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
    own = input_lags(model.inputs(), inputs)
    claims = [
        replace(of, holds=of.holds + held((id_, own[id_].unknown) for id_ in sorted(of.rests_on)))
        for of in model.claims(inputs, frequency) or (result,)  # one that names no claims has one
    ]
    facts = MonitorFacts(
        model.kind,
        model.name,
        digest,
        source.file_name,
        source.sha256,
        tuple(input_facts),
        path,
        tuple(claims),
        (*of_model, *accepted),
        tuple(model.elements()),
        dict(model.links) or None,
    )
    return module, facts


def input_lags(items: Sequence[ModelInput], inputs: Sequence[BoundInput]) -> dict[str, Lag]:
    """Return for each input the lag of its expression, and of the inputs that this reads."""
    is_good = {item.id: item.is_good for item in items}
    ids = {input_.attribute: input_.id for input_ in inputs}
    result = dict.fromkeys(ids.values(), Lag())
    for input_ in inputs:
        expression, good = input_.expression or {"parts": ()}, is_good[input_.id]
        for part in expression["parts"]:
            program: Program = part["program"]
            is_truth = good is not None and expression["type"] == "bool"
            wanted = good(True) - good(False) if good is not None and is_truth else 0
            for name, lag in lags(program, program.results[0].operation, wanted).items():
                below = result.get(ids.get(name, ""), Lag())
                result[input_.id] = result[input_.id].longest(lag.plus(below))
    return result


def names_read(expression: Mapping[str, Any] | None) -> tuple[str, ...] | None:
    """Return the names of fields and inputs that an expression reads; ``None`` for none."""
    if expression is None:
        return None
    reads = (read for part in expression["parts"] for read in part["program"].reads)
    return tuple(dict.fromkeys(name for read in reads for name in inputs_of(read)))
