"""From a bound model to the text of ``compiled.py``, and to the facts that others read of it."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from importlib import import_module
from typing import Any

from eddi_runtime import ModelError as NotRunning
from eddi_runtime.history import EDDIInputBase

from eddi_scaffold.common.claims import Acceptance, Claim, Meanings
from eddi_scaffold.common.problems import EddiError, Place, error
from eddi_scaffold.compiling.compilation import module_text
from eddi_scaffold.compiling.document import ModelError, ModelFile, digest_of
from eddi_scaffold.compiling.execution import module_of
from eddi_scaffold.compiling.monitor import BoundInput, CompiledMonitor, Declaration
from eddi_scaffold.compiling.program.instructions import Program
from eddi_scaffold.conditions.uses import inputs_of
from eddi_scaffold.kinds import JsonValue, Kind, Model
from eddi_scaffold.monitors.facts import Element, InputFacts, MonitorFacts


@dataclass(frozen=True)
class CompiledModule:
    """What a package, or a program that plays it, runs.

    Attributes:
        text: of ``compiled.py`` where the runtime is installed, without the last line end.
        tables: name -> content of the files that must lie next to it.
        program: its step, of a kind that is compiled to one.
    """

    text: str
    tables: Mapping[str, bytes] = field(default_factory=dict)
    program: Program | None = None

    def monitor(self, model_id: str) -> Any:
        """Return a new monitor, as the package would load it; hand-written code is not in it."""
        return module_of(f"{self.text}\n", model_id, self.tables.__getitem__).Monitor()


def compile_monitor(
    model: Model,
    kind: Kind[Model],
    inputs: Sequence[BoundInput],
    accepted: Sequence[Acceptance],
    frequency: float,
    place: Place,
) -> tuple[CompiledModule, MonitorFacts]:
    """Compile a configured model, run the result once, and return it with its facts.

    Args:
        model: what is monitored.
        kind: its kind.
        inputs: as they are bound.
        accepted: what the configuration accepts for single inputs.
        frequency: steps per second.
        place: of the configuration, for errors.

    Raises:
        EddiError: the model or the settings cannot be compiled (K028).
    """
    try:
        document = _document(model, kind, inputs)
        source = model.source
        declaration = Declaration(model.name, document["sha256"], tuple(inputs))
        compiled = _compiled(model, kind, declaration, document)
        text = module_text(
            _model_file(model, declaration, document),
            {kind.name: compiled.format},
            compiled.lines,
            modules_of_kind=compiled.modules,
        )
        module = CompiledModule(text.removesuffix("\n"), compiled.tables, compiled.program)
        EDDIInputBase().bind(module.monitor(model.name).inputs)
    except (ModelError, NotRunning) as refused:  # what will run it has the last word
        raise EddiError(error("K028", refused.reason, place)) from None
    timeouts = {**kind.functions.limits(document), **kind.functions.input_timeouts(model)}
    facts = MonitorFacts(
        kind.name,
        model.name,
        declaration.digest,
        source.file_name,
        source.sha256,
        tuple(_input_facts(one, timeouts.get(one.id)) for one in inputs),
        model.place.path,
        tuple(_claims(model, kind, inputs, frequency, document)),
        (*_acceptances(model, kind, inputs, frequency, document), *accepted),
        tuple(_elements(document["model"], in_eddi=bool(model.place.path))),
        dict(model.links) or None,
    )
    return module, facts


def _input_facts(one: BoundInput, timeout_s: float | None) -> InputFacts:
    limits = [] if timeout_s is None else [timeout_s]
    forms = [part["form"] for part in one.expression["parts"]] if one.expression else []
    for form in forms:
        timeouts = [variable.get("timeout") for variable in form["variables"]]
        if timeouts and None not in timeouts:
            limits.append(max(timeouts) / 1e9)
    return InputFacts(
        one.id,
        one.attribute,
        one.requires,
        one.max_age,
        min(limits, default=None),
        one.every_message,
        names_read(one.expression),
    )


def names_read(expression: Mapping[str, Any] | None) -> tuple[str, ...] | None:
    """Return the names of fields and inputs that an expression reads; ``None`` for none."""
    if expression is None:
        return None
    variables = (of for part in expression["parts"] for of in part["form"]["variables"])
    return tuple(dict.fromkeys(name for of in variables for name in inputs_of(of)))


# Kinds that are not compiled from their typed model yet: the document that they were compiled from.


def meanings_of(kind: Kind[Model], claims: Sequence[Claim] | None) -> Meanings:
    """Return what the fields of a kind's messages mean on a topic with some claims."""
    functions = kind.functions
    if functions.field_meanings is not None:
        return functions.field_meanings(claims)
    if claims is None:
        return functions.meanings(None, None)
    outputs = [{"id": claim.id, "polarity": claim.polarity} for claim in claims]
    return functions.meanings({"form": {"outputs": outputs}}, None)


def _document(model: Model, kind: Kind[Model], inputs: Sequence[BoundInput]) -> dict[str, Any]:
    data: dict[str, JsonValue] = {
        "format": 1,
        "kind": kind.name,
        "id": model.name,
        "source": {
            "file": model.source.file_name,
            "sha256": model.source.sha256,
            "path": model.place.path,
        },
        "inputs": [_input_document(one) for one in inputs],
        "model": kind.functions.runtime_model(model),
        "settings": kind.functions.settings(model),
    }
    if model.links:
        data["links"] = {path: link.as_json() for path, link in model.links.items()}
    document: dict[str, Any] = json.loads(json.dumps(data))
    return {**document, "sha256": digest_of(data)}


def _input_document(one: BoundInput) -> dict[str, JsonValue]:
    return {
        **({"every_message": True} if one.every_message else {}),
        **({"expression": one.expression} if one.expression is not None else {}),
        "id": one.id,
        "attribute": one.attribute,
        "requires": list(one.requires),
        "max_age": one.max_age,
        "factor": list(one.factor) if one.factor else None,
        "default": one.default,
        **({"accepts": list(one.accepts)} if one.accepts else {}),
    }


def _model_file(model: Model, declaration: Declaration, document: Mapping[str, Any]) -> ModelFile:
    return ModelFile(
        "",
        model.kind,
        declaration.model_id,
        declaration.digest,
        document["source"],
        declaration.inputs,
        document["model"],
        document["settings"],
        lambda _: b"",
    )


def _compiled(
    model: Model, kind: Kind[Model], declaration: Declaration, document: Mapping[str, Any]
) -> CompiledMonitor:
    if kind.functions.compile is not None:
        return kind.functions.compile(model, declaration)
    emission: Any = import_module(f"eddi_scaffold.compiling.{kind.name}.emission")
    file = _model_file(model, declaration, document)
    program_of = getattr(emission, "program_of", None)
    return CompiledMonitor(
        emission.FORMAT,
        emission.lines_of(file),
        getattr(emission, "MODULES", ()),
        kind.functions.data_files(model),
        program_of(file) if program_of is not None else None,
    )


def _claims(
    model: Model,
    kind: Kind[Model],
    inputs: Sequence[BoundInput],
    frequency: float,
    document: Mapping[str, Any],
) -> Sequence[Claim]:
    functions = kind.functions
    if functions.claims is not None:
        return functions.claims(model, inputs, frequency)
    hold_s = functions.lag(document, frequency)
    outputs = document["model"].get("form", {"outputs": ()})["outputs"]
    polarity = {output["id"]: output["polarity"] for output in outputs}
    resting = functions.support(document) or {"": frozenset(one.id for one in inputs)}
    return [Claim(id_, of, hold_s, polarity.get(id_, "")) for id_, of in resting.items()]


def _acceptances(
    model: Model,
    kind: Kind[Model],
    inputs: Sequence[BoundInput],
    frequency: float,
    document: Mapping[str, Any],
) -> Sequence[Acceptance]:
    if kind.functions.acceptances is not None:
        return kind.functions.acceptances(model, inputs, frequency)
    return kind.functions.accepted(document, frequency)


_LINE = re.compile(r"line ([0-9]+)")


def _elements(model: Mapping[str, Any], *, in_eddi: bool) -> Iterator[Element]:
    """Yield what has an id or a name, list by list in the order of their names."""
    for name, items in sorted(model.items()):
        for item in items if isinstance(items, Sequence) and not isinstance(items, str) else ():
            id_ = item.get("id", item.get("name")) if isinstance(item, dict) else None
            if isinstance(id_, str):
                line = _LINE.fullmatch(str(item.get("place")))
                yield Element(
                    name.removesuffix("s").replace("_", " "),
                    id_,
                    item.get("class_name"),
                    item.get("line", int(line[1]) if line else None),
                    item.get("path") or None,
                )
    form = model.get("form") or {"outputs": []}  # of events: where the condition of each is
    for item in form["outputs"]:
        at = None if in_eddi else form["nodes"][item["node"]]["at"][0]  # of its own text there
        yield Element("event", item["id"], line=at)
    if "reference" in model:  # of SafeML: the sample, a file of its own
        yield Element("reference", model["reference"]["name"])
