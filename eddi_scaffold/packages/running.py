"""A generated package made ready to be played, with the lines that people wrote in it.

Loading one **executes its code**, as its node does: only for a folder that a person names for it.
"""

from __future__ import annotations

import importlib
import re
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from eddi_runtime.history import EDDIInputBase
from eddi_runtime.plain_values import one_line

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.identifiers import is_package_name
from eddi_scaffold.common.problems import EddiError, Place, Problem, problem
from eddi_scaffold.config.field_types import python_type
from eddi_scaffold.config.file import ConfigFile, from_json
from eddi_scaffold.config.schema import SimulatorOutput
from eddi_scaffold.kinds import Model, ModelInput, kinds
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.compiling import CompiledModule, MonitorFacts
from eddi_scaffold.monitors.compiling import from_json as facts_of
from eddi_scaffold.monitors.input_binding import InputBinding, fits
from eddi_scaffold.monitors.message_types import known_messages
from eddi_scaffold.packages.handwritten import written
from eddi_scaffold.packages.rendering import ANSWERS_FILE, read_answers
from eddi_scaffold.recordings.node import Message, Received, ReplayedNode, Step, blank
from eddi_scaffold.recordings.playing import Playback, Running

_CALL = re.compile(r'(?m)^  File "(.+)", line ([0-9]+), in ')  # a line of a traceback


@dataclass(frozen=True)
class Packaged:
    """A package whose code has been loaded."""

    monitor: BoundMonitor  # as far as the package remembers it
    by_hand: frozenset[str]  # ids of the inputs that hand-written lines make of their messages
    new: Callable[[], tuple[Any, Any]]  # makes an `EDDIMonitor` and an `EDDIInput`
    folder: Path  # as it was named

    def from_messages(self) -> Running:
        """Return its monitor, and a node that is given messages."""
        eddi_monitor, eddi_input = self.new()
        return _running(eddi_monitor, eddi_input)

    def from_values(self) -> Running:
        """Return its monitor, and a node whose inputs are given values.

        Hand-written lines get a message with the value where one has room for nothing else.
        """
        eddi_monitor, eddi_input = self.new()
        if not hasattr(eddi_input, "begin_step"):  # of the D7.2 tools: it takes messages alone
            eddi_input = EDDIInputBase()
        updates = [(b.model, self._process(b, eddi_input)) for b in self.monitor.inputs]

        def processing(values: Mapping[str, Any]) -> None:
            for model, process in updates:
                update = eddi_input.update_each if model.every_message else eddi_input.update
                update(model.id, process, values, [model.id])
            eddi_input.processed(values)

        eddi_input.processing = processing
        return _running(eddi_monitor, eddi_input)

    def _process(self, binding: InputBinding, eddi_input: Any) -> Callable[[Any], None]:
        name = binding.attribute
        message_for = _message_for(binding)
        process = getattr(eddi_input, f"process_{name}", None)  # none in a class of the D7.2 tools
        if binding.model.id not in self.by_hand or message_for is None or process is None:
            return lambda value: setattr(eddi_input, name, value)
        return lambda value: process(message_for(value))

    def out_of_reach(self) -> Iterator[Problem]:
        """Warn of hand-written lines that a CSV file cannot reach (I001)."""
        ids = [
            binding.model.id
            for binding in self.monitor.inputs
            if binding.model.id in self.by_hand and _message_for(binding) is None
        ]
        if ids:
            message = f"a CSV file has no messages for the hand-written lines of {', '.join(ids)}"
            yield problem("I001.bodies", message=message)

    def raising(self, play: Playback, report: Callable[[Problem], None]) -> Playback:
        """Warn of the first exception of each hand-written method when it was raised (I014)."""
        reported: set[str] = set()
        root = self.folder.resolve()
        for monitor, step in play:
            for name in sorted(monitor.node.raised.keys() - reported):
                reported.add(name)
                reason, traceback = monitor.node.raised[name]
                place = Place(str(self.folder))
                for path, line in _CALL.findall(traceback):
                    if Path(path).is_relative_to(root):  # the last one of its own
                        place = Place(str(self.folder / Path(path).relative_to(root)), int(line))
                report(problem("I014.raises", place, name=name, time=step.t, reason=reason))
            yield monitor, step


class _HandwrittenNode(ReplayedNode):
    """A node of hand-written code, which may print: data are ours alone."""

    def step(self, t: int, messages: Sequence[Received], clock: int | None = None) -> Step:
        with redirect_stdout(sys.stderr):
            return super().step(t, messages, clock)


def _running(eddi_monitor: Any, eddi_input: Any) -> Running:
    node = _HandwrittenNode(eddi_input, eddi_monitor.monitor, eddi_monitor.execute_step)
    return eddi_monitor.monitor, node


def _message_for(binding: InputBinding) -> Callable[[Any], Any] | None:
    """Return what makes the one message of a value, ``None`` where that cannot be done."""
    if len(binding.requires) != 1:
        return None
    message_type = binding.requires[0].type
    if not message_type:  # a plain package: the value itself
        return lambda value: value
    fields = known_messages().get(message_type, {})
    if len(fields) != 1:
        return None
    ((field, type_),) = fields.items()
    if not fits(python_type(type_), binding.model.type):
        return None
    return lambda value: Message(**{**vars(blank(message_type)), field: value})


def load(folder: Path) -> Packaged:
    """Load the code of a package; EddiError I020 if it is none, or its code cannot be loaded."""
    place = Place(str(folder))
    answers = read_answers(folder) or {}
    try:
        name = answers["package"]
        config = from_json(answers["config_json"], str(folder)) if answers["config_json"] else None
        edited = set(written(folder))
        facts = facts_of(answers["facts_json"])
        by_hand = frozenset(i.id for i in facts.inputs if f"process_{i.attribute}" in edited)
        monitor = _remembered(folder, answers, config, facts, by_hand)
    except (AttributeError, LookupError, RecursionError, TypeError, ValueError):
        raise EddiError(problem("I020.package", place, answers=ANSWERS_FILE)) from None
    if not isinstance(name, str) or not is_package_name(name):
        raise EddiError(problem("I020.name", place, name=name))
    try:
        new = _imported(folder.resolve(), name)
        new()
    except Exception as failure:  # noqa: BLE001 - whatever hand-written code raises
        raise EddiError(problem("I020.code", place, reason=one_line(failure))) from None
    return Packaged(monitor, by_hand, new, folder)


def _imported(folder: Path, name: str) -> Callable[[], tuple[Any, Any]]:
    """Import the package as its node or a program would, and leave no file behind."""
    for place in (folder / "src", folder):
        if (place / name / "EDDIMonitor.py").is_file():
            break
    else:  # the folder is the Python package itself
        place, name = folder.parent, folder.name
    for loaded in [key for key in sys.modules if key.partition(".")[0] == name]:
        del sys.modules[loaded]
    before, sys.dont_write_bytecode = sys.dont_write_bytecode, True
    sys.path.insert(0, str(place))
    try:
        with redirect_stdout(sys.stderr):
            monitor_class = importlib.import_module(f"{name}.EDDIMonitor").EDDIMonitor
            input_class = importlib.import_module(f"{name}.EDDIInput").EDDIInput
    finally:
        sys.path.remove(str(place))
        sys.dont_write_bytecode = before
    return lambda: (monitor_class(), input_class())


def _remembered(
    folder: Path,
    answers: Mapping[str, Any],
    config: ConfigFile | None,
    facts: MonitorFacts,
    by_hand: frozenset[str],
) -> BoundMonitor:
    """Return a monitor as its package remembers it: without the elements of its model."""
    types = {input_["attribute"]: input_["type"] for input_ in answers["inputs"]}
    sources = {s.id: s for s in config.config.SimulatorOutputs} if config is not None else {}
    inputs = []
    for entry in facts.inputs:
        own = SimulatorOutput.model_construct(id=entry.id, type="", topic="", max_age=None)
        inputs.append(
            InputBinding(
                ModelInput(entry.id, types[entry.attribute], every_message=entry.every_message),
                entry.attribute,
                tuple(sources[name] for name in entry.requires) if sources else (own,),
                expression=None if entry.id in by_hand else "",
                max_age=entry.max_age,
                reads=None if entry.id in by_hand else entry.reads,
            )
        )
    kind = kinds()[answers["kind"]]
    model = Model(facts.id, Source(str(folder / ANSWERS_FILE), b""), Place(str(folder)))
    compiled = CompiledModule(answers["compiled"])
    joined = (answers["package"], model, kind, config, tuple(inputs), compiled, facts, model)
    return BoundMonitor(*joined)
