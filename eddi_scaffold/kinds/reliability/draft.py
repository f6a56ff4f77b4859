"""What a configuration has to say of chains and trees: the horizon, and what is observed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from eddi_scaffold.common.files import Source
from eddi_scaffold.eddi_xml.reading import recognises
from eddi_scaffold.kinds import TODO, JsonValue, ModelDraft
from eddi_scaffold.kinds.reliability.inputs import inputs_of
from eddi_scaffold.kinds.reliability.lowering import used
from eddi_scaffold.kinds.reliability.system import Chain, FaultTree, ReliabilitySystem

_NAMES = 12


def drafted(
    source: Source, system: ReliabilitySystem, configured: ReliabilitySystem | None
) -> ModelDraft:
    """Return what a model of an EDDI leaves open; a reliability_config.yml says it itself.

    Args:
        source: of the system.
        system: as in its file.
        configured: with what is decided already, ``None`` where that does not fit.
    """
    inputs = inputs_of(used(configured)) if configured is not None else []
    if not recognises(source):
        return ModelDraft(inputs)
    models: dict[str, JsonValue] = {}
    notes: dict[tuple[str, ...], str] = {("horizon",): "how far ahead, for instance 30 min"}
    for name, key, note in _open(system):
        models[name] = {key: TODO}
        notes["models", name, key] = note
    return ModelDraft(inputs, {"horizon": TODO, **({"models": models} if models else {})}, notes)


def _open(system: ReliabilitySystem) -> Iterator[tuple[str, str, str]]:
    """Yield the models that something can be observed of: name, key, what there is to say."""
    for name, component in used(system).components.items():
        content = component.content
        if isinstance(content, Chain) and not content.observe:
            states = ", ".join(f"{state}: INPUT" for state in content.states[:_NAMES])
            yield name, "observe", f"{{{states}}}, or `not INPUT`: false excludes the state"
        elif isinstance(content, FaultTree):
            events = content.events.items()
            free = [key for key, event in events if not event.law or not event.law.model]
            if free and not any(event.observed for _, event in events):
                names = ", ".join(free[:_NAMES])
                yield name, "events", f"{{EVENT: {{observed: true}}}} of {names}; {{}} for none"


def decided(value: Mapping[str, JsonValue]) -> dict[str, JsonValue]:
    """Return options without what is still to be decided."""
    return {
        key: decided(one) if isinstance(one, Mapping) else one
        for key, one in value.items()
        if one != TODO
    }
