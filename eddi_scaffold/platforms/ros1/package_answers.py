"""The answers of the packages of a ROS 1 workspace."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from eddi_scaffold import __version__, platforms
from eddi_scaffold.compiling.compilation import compile_model
from eddi_scaffold.compiling.document import ModelError, parse_model
from eddi_scaffold.compiling.parts import HOST, needed_by
from eddi_scaffold.config.file import ConfigFile
from eddi_scaffold.config.message_types import packages_of
from eddi_scaffold.config.schema import Config, SimulatorOutput
from eddi_scaffold.escaping import python_literal
from eddi_scaffold.kinds import JsonValue
from eddi_scaffold.monitors.answers import identity_answers, shared_answers
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.publications import MESSAGE_PACKAGE, Publication, publications
from eddi_scaffold.platforms import PackageAnswers
from eddi_scaffold.platforms.ros1 import templates
from eddi_scaffold.platforms.ros1.messages import messages_of
from eddi_scaffold.platforms.ros1.mros_models import interfaces_of, nodes_of, specs_of
from eddi_scaffold.platforms.ros1.names import LAUNCHER, METAPACKAGE, RUNTIME
from eddi_scaffold.platforms.ros1.outputs import publication_answers, rows
from eddi_scaffold.problems import EddiError, Place, Problem, error

_RELEASE = ".".join(__version__.split(".")[:3])
"""Version of the packages that all monitors share: they come with the generator."""


def monitor_answers(monitor: BoundMonitor) -> tuple[PackageAnswers, list[Problem]]:
    """Return the answers of one monitor package; the configuration is there (``needs_config``)."""
    assert monitor.config is not None, "the ros1 platform needs a configuration"
    config = monitor.config.config
    found, problems = publications(monitor, monitor.config)
    published = rows(found)
    heard = [source.type for source in config.SimulatorOutputs if _used(monitor, source.id)]
    classes = _class_names([*heard, *(p.type for p in published if p.path)])
    classes |= {p.type: p.type.replace("/", ".msg.") for p in published if not p.path}
    answers = shared_answers(monitor, templates.MONITOR)
    answers |= {platforms.RUNTIME: platforms.VENDORED, platforms.SINGLE_PROCESS: False}
    answers["message_packages"] = sorted(
        {name.partition("/")[0] for name in classes} - {MESSAGE_PACKAGE}
    )
    answers["system_packages"] = [f"python3-{name}" for name in monitor.kind.requirements]
    answers["frequency"] = repr(config.Model.frequency)
    answers["mode"] = config.Model.mode
    answers["startup_grace"] = repr(config.Model.startup_grace)
    answers["message_imports"] = _imports(classes)
    answers["subscriptions"] = [
        {
            "id": python_literal(source.id),
            "topic": python_literal(source.topic),
            "message_class": classes[source.type],
            "more": ", every_message=True" if _takes_every(monitor, source.id) else "",
        }
        for source in _subscribed(monitor)
    ]
    answers["publications"] = [
        publication_answers(publication, classes, monitor.kind.functions.beside(monitor.model))
        for publication in published
    ]
    answers["interfaces"] = interfaces_of(found, _subscribed(monitor))
    files = {
        f"src/{monitor.package}/{n}": data
        for n, data in monitor.kind.functions.data_files(monitor.model).items()
    }
    problems += _check(monitor, monitor.config, published)
    return PackageAnswers(monitor.package, answers, files), problems


def support_answers(
    monitors: Mapping[str, Mapping[str, JsonValue]], config: Config | None
) -> list[PackageAnswers]:
    """Return the answers of messages, launcher, metapackage, and of the runtime if one needs it."""
    texts = messages_of(monitors)
    messages = [{"name": name, "text": texts[name]} for name in sorted(texts)]
    where = [str(one.get(platforms.RUNTIME, platforms.VENDORED)) for one in monitors.values()]
    single = all(one.get(platforms.SINGLE_PROCESS) is True for one in monitors.values())
    runtime = platforms.VENDORED if platforms.VENDORED in where else platforms.INSTALLED
    listed = sorted(monitors)

    def package(template: str, name: str, description: str, **more: JsonValue) -> PackageAnswers:
        answers = {"template": template, **identity_answers(name, description, None), **more}
        answers["package_version"] = _RELEASE
        if config is not None and config.Package.maintainer is not None:
            answers |= {
                key: identity_answers(name, description, config)[key]
                for key in ("maintainer_name", "maintainer_email", "license")
            }
        return PackageAnswers(name, answers)

    packages = [
        package(
            templates.MESSAGES,
            MESSAGE_PACKAGE,
            "Messages of the EDDI runtime monitors",
            messages=messages,
            specs=specs_of(texts),
            message_packages=packages_of(texts.values()),
        ),
        package(
            templates.METAPACKAGE,
            METAPACKAGE,
            "All EDDI runtime monitors of this workspace",
            monitors=listed,
            runtime=runtime,
        ),
        package(
            templates.LAUNCHER,
            LAUNCHER,
            "Launch file that starts every EDDI runtime monitor of this workspace",
            monitors=listed,
            single_process=single,
            nodes=nodes_of(monitors),
        ),
    ]
    if runtime == platforms.VENDORED:
        parts = {part for name, one in monitors.items() for part in _parts(name, one)}
        parts |= {HOST} if single else set()
        title = "Runtime library of the EDDI monitors"
        packages.append(package(templates.RUNTIME, RUNTIME, title, parts=sorted(parts)))
    return packages


def _parts(package: str, answers: Mapping[str, JsonValue]) -> Sequence[str]:
    """Return the parts of the runtime that a monitor needs.

    Raises:
        EddiError: its model cannot be compiled, perhaps of an older release (K028).
    """
    try:
        return needed_by(compile_model(parse_model(str(answers["model_json"]))))
    except ModelError as refused:
        raise EddiError(error("K028", refused.reason, Place(package))) from None


def _used(monitor: BoundMonitor, source_id: str) -> bool:
    return any(source_id == source.id for binding in monitor.inputs for source in binding.requires)


def _takes_every(monitor: BoundMonitor, source_id: str) -> bool:
    """Return whether some input takes every message of this topic, not the latest one."""
    return any(
        binding.model.every_message and binding.requires[:1] and binding.requires[0].id == source_id
        for binding in monitor.inputs
    )


def _subscribed(monitor: BoundMonitor) -> Iterable[SimulatorOutput]:
    """Return the simulator outputs that an input requires, in the order of the configuration."""
    assert monitor.config is not None
    seen: set[str] = set()
    for source in monitor.config.config.SimulatorOutputs:
        if _used(monitor, source.id) and source.id not in seen:
            seen.add(source.id)
            yield source


def _class_names(types: Iterable[str]) -> dict[str, str]:
    """Return message type -> Python name; equal names of two packages get the package before."""
    unique = sorted(set(types))
    names = [name.partition("/")[2] for name in unique]
    return {
        full: (
            name
            if names.count(name) == 1
            and name
            not in {"Input", "Output", "RosNode", "EDDIInput", "EDDIMonitor", "MonitorNode"}
            else full.replace("/", "_")
        )
        for full, name in zip(unique, names, strict=True)
    }


def _imports(classes: dict[str, str]) -> list[str]:
    lines = []
    for full, name in sorted(classes.items()):
        package, _, message = full.partition("/")
        if name.startswith("eddi_messages.msg."):
            continue
        alias = "" if name == message else f" as {name}"
        lines.append(f"from {package}.msg import {message}{alias}")
    return lines


def _check(
    monitor: BoundMonitor, config: ConfigFile, published: Sequence[Publication]
) -> Iterable[Problem]:
    """Find outputs that are missing, heard by their own monitor, or of two types on one topic.

    Topics are compared as a node outside of any namespace resolves them: `a/b` is `/a/b` there.
    """
    if not config.config.EDDIOutputs:
        message = "EDDIOutputs names no topic: the result would not be published"
        hint = "add `- id: ...` with `topic: ...`; for plain Python: --platform plain"
        yield error("K030", message, config.place("EDDIOutputs"), hint)
    heard = {monitor.topic(one.topic) for one in config.config.SimulatorOutputs}
    types: dict[str, str] = {}
    for one in published:
        written = one.output.topic
        topic = monitor.topic(written)
        if topic in heard:
            message = f"the monitor would listen to its own output {written}"
            yield error("K031", message, one.place)
        if types.setdefault(topic, one.type) != one.type:
            message = f"the topic {written} would carry {types[topic]} and {one.type}"
            yield error("K031", message, one.place, "give each output a topic of its own")
