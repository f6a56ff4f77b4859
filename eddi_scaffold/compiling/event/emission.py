"""The class ``Monitor`` of events: what each is called and needs as tables, its step as text."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from eddi_scaffold.compiling.document import InputData, ModelError, ModelFile, take, texts
from eddi_scaffold.compiling.expressions.form import BOOL, Form, read_form, used_variables
from eddi_scaffold.compiling.expressions.sampling import HostInput, Sampling
from eddi_scaffold.compiling.expressions.source import Source, names_of, stamp_name
from eddi_scaffold.compiling.inputs import attribute_of, head_lines
from eddi_scaffold.compiling.text import (
    Part,
    assignment,
    call,
    literal,
    text_literal,
    tuple_of,
    unpacked,
)

FORMAT = 1


def lines_of(model_file: ModelFile) -> list[str]:
    """Return the lines of the class.

    Raises:
        ModelError: the model is wrong.
    """
    form = read_form(take(model_file.model, "form", dict, "the model"))
    if any(form.nodes[output.node].type != BOOL for output in form.outputs):
        raise ModelError("", "an event is no truth value")
    sampling = Sampling(form)
    numbers = {spec.id: k for k, spec in enumerate(model_file.inputs)}
    missing = [one.name for one in sampling.inputs if one.name not in numbers]
    if missing:
        raise ModelError("", f"there is no input for the variable {missing[0]!r}")
    places = [numbers[one.name] for one in sampling.inputs]
    given = {one.name: one for one in sampling.inputs}
    types = (_type(given.get(spec.id)) for spec in model_file.inputs)
    events = _events(form, sampling, places, model_file.model)
    lines = [
        *head_lines("event.EventMonitor", model_file, {}),
        *assignment("types", tuple_of(types), 4),
        *assignment("events", tuple_of(events), 4),
    ]
    reduced = [
        places[used[0]]
        for variable, used in zip(form.variables, sampling.uses, strict=True)
        if variable.reduction is not None
    ]
    if reduced:
        lines += assignment("reductions", literal(tuple(reduced)), 4)
    return [*lines, *_methods(form, sampling, model_file.inputs)]


def _events(
    form: Form, sampling: Sampling, places: Sequence[int], model: Mapping[str, object]
) -> Iterator[Part]:
    accepts = model.get("accepts", {})
    if not isinstance(accepts, dict):
        raise ModelError("", "'accepts' of the model is no object")
    words = {name: texts(found, f"'accepts' of {name!r}") for name, found in accepts.items()}
    for output, used in zip(form.outputs, used_variables(form), strict=True):
        needs = sorted({one for k in used for one in sampling.uses[k]})
        more = {"accepts": literal(words[output.id])} if words.get(output.id) else {}
        numbers = literal(tuple(places[one] for one in needs))
        yield call("event.Event", [text_literal(output.id), str(output.hazard), numbers], **more)


def _type(one: HostInput | None) -> Part:
    if one is None:
        return '""'
    if one.list:
        return '"list"'
    return literal(one.literals) if one.type == "enum" else text_literal(one.type)


def _methods(form: Form, sampling: Sampling, inputs: Sequence[InputData]) -> list[str]:
    names, variables = names_of(form, sampling)
    source = Source(form, variables)
    named = dict(zip((one.name for one in sampling.inputs), names, strict=True))
    lines = [*source.members(), "", "    def step(self, source, t):"]
    lines += _read(inputs, [named.get(spec.id, "_") for spec in inputs])
    reductions = 0
    for k, (variable, used) in enumerate(zip(form.variables, sampling.uses, strict=True)):
        if variable.reduction is not None:
            raws = [names[one] for one in used]
            value = call("self.reduce", [str(reductions), f"self.reduce_{k}", *raws])
            lines += assignment(variables[k], value, 8)
            reductions += 1
        elif variables[k] != names[used[0]]:
            lines += [f"        {variables[k]} = {names[used[0]]}"]
        if variable.stamped:
            stamp = call("self.stamp", ["t", text_literal(sampling.inputs[used[0]].name)])
            lines += assignment(stamp_name(variables[k]), stamp, 8)
    return [*lines, *source.evaluation(raw=True)]


def _read(inputs: Sequence[InputData], names: Sequence[str]) -> list[str]:
    if not inputs:
        return []
    lines = ["        try:", *assignment("raw", tuple_of(map(_value, inputs)), 12)]
    lines += ["        except Exception:", "            raw = self.read(source)"]
    return [*lines, "        self.raw = raw", *unpacked(names, "raw")]


def _value(one: InputData) -> Part:
    value = attribute_of("source", one.attribute)
    if one.factor is None:
        return value
    return call("expressions.scaled", [value, *map(str, one.factor)])
