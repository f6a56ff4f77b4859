"""A configuration whose demands are fed by guarantees of other robots."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.config.schema import InputEntry, SimulatorOutput
from eddi_scaffold.identifiers import attribute, free_name, key_text
from eddi_scaffold.problems import Place


@dataclass(frozen=True)
class GuaranteeSource:
    """One guarantee as one topic brings it.

    Attributes:
        output: the topic; its id is only a wish.
        guarantee: id in the message.
    """

    output: SimulatorOutput
    guarantee: str


def fed(
    config: ConfigFile,
    demand: str,
    sources: Sequence[GuaranteeSource],
    max_age: float,
    place: Place,
) -> ConfigFile:
    """Return a configuration whose demand is fulfilled while one of some guarantees is active.

    Args:
        config: of the monitor; what it says itself of where the demand comes from is replaced.
        demand: id of the input.
        sources: the guarantees.
        max_age: of the input where the configuration has none.
        place: where the deployment file says so.
    """
    form, places = config.config, dict(config.places)
    outputs = list(form.SimulatorOutputs)
    names: list[str] = []
    for source in sources:
        taken = {attribute(one.id) for one in (*outputs, *form.EDDIInputs)}
        names.append(free_name(attribute(source.output.id), taken))
        places["SimulatorOutputs", len(outputs)] = place
        outputs.append(source.output.model_copy(update={"id": names[-1]}))
    fields = [f"guarantees[{key_text(one.guarantee)}].active" for one in sources]
    how: dict[str, object] = {"field": fields[0]}
    if len(sources) > 1:
        words = [f"{name}.{field}" for name, field in zip(names, fields, strict=True)]
        how = {"expression": " OR ".join(words)}
    entries = list(form.EDDIInputs)
    index = next((k for k, one in enumerate(entries) if one.id == demand), len(entries))
    old = entries[index] if index < len(entries) else InputEntry(id=demand, type="bool")
    computed = {"field": None, "expression": None, "expression_file": None, "states": None}
    age = max_age if old.max_age is None else old.max_age
    new = {**computed, **how, "requires": names, "max_age": age}
    entries[index : index + 1] = [old.model_copy(update=new)]
    places |= {("EDDIInputs", index, key): place for key in ("requires", *how)}
    places.setdefault(("EDDIInputs", index), place)
    update = {"SimulatorOutputs": outputs, "EDDIInputs": entries}
    return replace(config, config=form.model_copy(update=update), places=places)
