"""The DDS node of one monitor: a participant of a ROS 2 graph, on a machine without ROS."""

from __future__ import annotations

import contextlib
import logging
import math
import os
import re
import signal
import sys
import time
from typing import Any, Mapping, NamedTuple, Sequence, Union

from ...inputs import UNKNOWN_AGE, EDDIInputBase
from ...monitor import Steps
from ...node.health import diagnostics_tree
from ...node.node import REFUSALS, NewInput, NewMonitor, Node, Statuses
from ...node.report import GraphFact, fault
from ...node.start import LOG, Settings, StartError, end_at_signals, settings, write_to_stderr
from ...node.topics import Input, Output, Publish, Topic
from .graph import Graph, Publication, reading, writing
from .messages import OWN, Unreadable, converter

_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_TOPIC = re.compile(r"(?:~/|/)?[A-Za-z_][A-Za-z0-9_]*(?:/[A-Za-z_][A-Za-z0-9_]*)*")
_DOMAINS = 233
Parameter = Union[bool, int, float, str]


class Arguments(NamedTuple):
    """Names, remaps and parameters of a node."""

    name: str  # of the node
    namespace: str  # ``/``, or such as ``/robot1``
    remaps: Mapping[str, str]  # full name of a topic -> the full name that is meant
    parameters: Mapping[str, Parameter]  # private parameters by name

    @property
    def full_name(self) -> str:
        return f"{self.namespace.rstrip('/')}/{self.name}"

    def topic(self, name: str) -> str:
        full = name if name.startswith("/") else f"{self.namespace.rstrip('/')}/{name}"
        if name.startswith("~/"):
            full = f"{self.full_name}/{name[2:]}"
        return self.remaps.get(full, full)


def arguments(words: Sequence[str], name: str) -> Arguments:
    """Return what the options of a command line say; StartError where one is not understood."""
    remaps: dict[str, str] = {}
    parameters: dict[str, Parameter] = {}
    for option, assignment in _pairs(words):
        key, separator, value = assignment.partition(":=")
        if not separator:
            raise StartError(f"{option} {assignment}: NAME:=VALUE is expected")
        if option in ("-p", "--param"):
            parameters[key] = _scalar(value)
        else:
            remaps[key] = value
    namespace = "/" + remaps.pop("__ns", "/").strip("/")
    name = remaps.pop("__node", remaps.pop("__name", name))
    if not _NAME.fullmatch(name):
        raise StartError(f"{name!r} is no name for a node")
    if namespace != "/" and not _TOPIC.fullmatch(namespace):
        raise StartError(f"{namespace!r} is no namespace")
    for topic in (topic for pair in remaps.items() for topic in pair):
        if not _TOPIC.fullmatch(topic):
            raise StartError(f"{topic!r} is no name of a topic")
    plain = Arguments(name, namespace, {}, parameters)
    full = {plain.topic(old): plain.topic(new) for old, new in remaps.items()}
    return plain._replace(remaps=full)


def _pairs(words: Sequence[str]) -> list[list[str]]:
    """Return option and value of all between ``--ros-args`` and ``--``."""
    options = [*words, "--ros-args"]
    begin = options.index("--ros-args")
    for word in options[:begin]:
        if word.startswith("-"):  # such as --help, or -p: to ignore it would be to start otherwise
            raise StartError(f"{word}: --ros-args -r NAME:=NAME -p NAME:=VALUE is expected")
    options = [*options[begin + 1 : -1], "--"]
    options = options[: options.index("--")]
    pairs = [options[k : k + 2] for k in range(0, len(options), 2)]
    for pair in pairs:
        if pair[0] not in ("-p", "--param", "-r", "--remap") or len(pair) < 2:
            raise StartError(f"{' '.join(pair)}: -r NAME:=NAME or -p NAME:=VALUE is expected")
    return pairs


def _scalar(text: str) -> Parameter:
    if text in ("true", "false"):
        return text == "true"
    for number in (int, float):
        with contextlib.suppress(ValueError):
            return number(text)
    return text


def domain_id(text: str) -> int:
    """Return the domain of ``ROS_DOMAIN_ID``, else StartError."""
    if text.isdecimal() and int(text) < _DOMAINS:
        return int(text)
    raise StartError(f"ROS_DOMAIN_ID is {text!r}, a number from 0 to {_DOMAINS - 1} is expected")


DISTROS = {"ros_distro": ("humble", "iron", "jazzy", "kilted", "lyrical", "rolling")}
_OWN = {*Settings._fields, *DISTROS, "use_sim_time", "partition"} - {"words"}
"""Parameters that are read."""
_DEPTH = 5


class MonitorNode(Node):
    """Base class of the generated node."""

    _graph: Graph  # that ``run`` joins

    def __init__(
        self, monitor: Steps, eddi_input: EDDIInputBase, options: Settings, words: Arguments
    ) -> None:
        super().__init__(monitor, eddi_input, converter(self.MESSAGES), options)
        self._words = words
        self._unreadable: dict[str, float] = {}
        self._clock: int | None = 0 if self._words.parameters.get("use_sim_time") is True else None

    def resolved(self, topic: str) -> str:
        return self._words.topic(topic)

    def advertise(self, channel: Output) -> Publish:
        qos = writing(channel.qos, self.options.queue_size)
        return self._graph.writer(self._words.topic(channel.topic), channel.type, qos)

    def subscribe(self, source: Input) -> None:
        def receive(message: Any, kept: bool) -> None:
            if isinstance(message, Unreadable):
                self._unreadable[source.id] = time.monotonic()
            else:
                self._receipts.receive(source.id, message, _age(message) if kept else 0.0)

        qos = reading(source.qos, source.waiting(_DEPTH))
        self._graph.reader(self._words.topic(source.topic), source.type, receive, qos)

    def simulated_ns(self) -> int | None:
        return self._clock

    def check_serialises(self, message: Any) -> None:
        message.serialize()

    def graph(self) -> GraphFact:
        quiet = self._silence.quiet(self._receipts.latest())
        known = self._graph.publications() if quiet else []
        topics = [self._topic(source, age, known) for source, age in quiet]
        return self._silence.explained(topics, {writer.topic for writer in known})

    def _topic(self, source: Input, age: float | None, known: Sequence[Publication]) -> Topic:
        name = self._words.topic(source.topic)
        own = [writer for writer in known if writer.topic == name]
        unreadable = time.monotonic() - self._unreadable.get(source.id, -math.inf)
        expected = str(source.type.TYPE)
        connected, alive, unfit = self._graph.listening(name)
        why = fault(
            expected,
            age,
            unreadable=unreadable < (math.inf if age is None else age),
            refused=unfit,
            connected=connected,
            alive=alive,
            deadline=min(filter(None, (writer.deadline for writer in own)), default=None),
        )
        return Topic(name, expected, {ros_type(writer.type) for writer in own}, age, why)

    def run(self) -> int:
        domain = domain_id(os.environ.get("ROS_DOMAIN_ID") or "0")
        words, distro = self._words, self.options.words["ros_distro"]
        partition = str(words.parameters.get("partition", ""))
        self._graph = joined = Graph(domain, words.namespace, words.name, distro, partition)
        if self._clock is not None:

            def tick(message: Any, _: bool) -> None:
                if not isinstance(message, Unreadable):
                    self._clock = message.clock.sec * 1_000_000_000 + message.clock.nanosec

            joined.reader("/clock", OWN.rosgraph_msgs_Clock, tick, reading({}, 1))
        self.ending.install()
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, lambda *_: self.ending.begin())
        style = "[%(levelname)s] [%(created).3f] %(message)s"
        logging.basicConfig(stream=sys.stderr, level=logging.INFO, format=style)
        log = logging.getLogger(words.full_name.strip("/").replace("/", "."))
        LOG.start({"info": log.info, "warn": log.warning, "error": log.error})
        try:
            self.run_on(words.full_name, self._statuses, joined.start)
            self.withdraw()  # the last word
        finally:
            self.ending.begin()
            joined.close()
            self.ending.wait()
        return self.ending.status

    def _statuses(self) -> Statuses:
        cls = OWN.diagnostic_msgs_DiagnosticArray
        write = self._graph.writer("/diagnostics", cls, writing({}, 1))
        made = converter(OWN, "diagnostic_msgs")
        return lambda statuses: write(made.message(diagnostics_tree(statuses)))

    @classmethod
    def main(cls, eddi_input_class: NewInput, eddi_monitor_class: NewMonitor) -> int:
        """Run the node of a generated package; return its exit status, 1: it cannot start."""
        end_at_signals()
        try:
            words = arguments(sys.argv[1:], cls.NAME)
            unknown = sorted(words.parameters.keys() - _OWN)
            if unknown:
                text = f"warning: no parameter is called {', '.join(unknown)}: nothing reads it"
                write_to_stderr(cls.NAME, text)
            options = settings(words.parameters, cls.FREQUENCY, cls.STARTUP_GRACE, DISTROS)
            node = cls(eddi_monitor_class(), eddi_input_class(), options, words)
            node.prepare()
            return node.run()
        except REFUSALS as error:
            write_to_stderr(cls.NAME, f"error: {error}")
            return 1


def _age(message: Any) -> float:
    """Return how old a kept message is by its header; one from the future may be of any age."""
    made = getattr(getattr(message, "header", None), "stamp", None)
    if made is None or not (made.sec or made.nanosec):
        return UNKNOWN_AGE
    age = time.time() - (made.sec + made.nanosec * 1e-9)
    return age if age >= 0.0 else UNKNOWN_AGE


def ros_type(name: str) -> str:
    """Return the ROS name of a type: ``std_msgs/Bool`` of ``std_msgs::msg::dds_::Bool_``."""
    return name.replace("::msg::dds_::", "/").rstrip("_")
