"""The messages of ROS 2 graphs, over DDS; needs the wheel `cyclonedds`, and no ROS."""

from __future__ import annotations

import threading
import time
from collections.abc import Collection, Iterable, Iterator, Sequence
from functools import lru_cache
from queue import Empty, SimpleQueue
from typing import Any

from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsPublication
from cyclonedds.core import (
    DDSException,
    InstanceState,
    ReadCondition,
    SampleState,
    ViewState,
    WaitSet,
)
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration
from eddi_runtime.transports.dds.graph import discovery_types, participant_of, reading
from eddi_runtime.transports.dds.messages import message_classes
from eddi_runtime.transports.dds.node import ros_type

from eddi_scaffold.common.problems import EddiError, problem
from eddi_scaffold.kinds import WHY
from eddi_scaffold.monitors.message_types import known_messages, ros2_fields, ros2_messages
from eddi_scaffold.platforms.dds import with_parts
from eddi_scaffold.watch.messages import (
    DIAGNOSTICS,
    GATHER_S,
    MAX_MONITORS,
    Message,
    is_watched,
    status_messages,
)

_PREFIX = "rt"
_EVERY_S = 1.0
_SOON_S = 0.2
_WAIT_S = 0.1
_GRACE_S = 2.0  # within which the graph tells the node of a writer, if it does
_DEPTH = 10
_PARTICIPANTS = 10_000  # each tells once of which nodes it is
_BATCH = 100
_MANY = 100_000
_BEFORE_STAMP, _BEHIND_STAMP = 4, 12  # bytes of a message
_REMEMBERED = 512
_GID_BYTES = (24, 16)  # of an identity on the graph up to Humble, and of later releases
_GUID_BYTES = 16
_ANY = ViewState.Any | InstanceState.Any | SampleState.Any
_GONE = (
    ViewState.Any
    | SampleState.Any
    | InstanceState.NotAliveDisposed
    | InstanceState.NotAliveNoWriters
)


class DdsGraphs:
    """What the monitors in some domains publish, from now on; times are of the monotonic clock.

    With several domains, a topic has ``/domain<id>`` before its name.

    Raises:
        EddiError: there is no such domain, or no network (I010).
    """

    def __init__(self, domains: Collection[int]) -> None:
        several = len(domains) > 1
        self._domains = [_Domain(id_, f"/domain{id_}" if several else "") for id_ in domains]
        self._received: SimpleQueue[tuple[float, Sequence[Message]]] = SimpleQueue()
        self._notes: tuple[str, ...] = ()
        self._ended = False
        # A thread of its own: Ctrl-C while DDS calls back into Python would be an error of DDS.
        self._thread = threading.Thread(target=self._run, name="dds", daemon=True)
        self._thread.start()

    def _run(self) -> None:
        wait_s = _WAIT_S / len(self._domains)
        while not self._ended:
            try:
                messages = [m for domain in self._domains for m in domain.receive(wait_s)]
                self._notes = tuple(note for domain in self._domains for note in domain.notes())
            except Exception as failure:  # noqa: BLE001 - whatever a driver raises
                self._notes = (f"dds: {type(failure).__name__}: {failure}",)
                time.sleep(_WAIT_S)
                continue
            if messages:
                self._received.put((time.monotonic(), messages))

    def receive(self, seconds: float) -> tuple[float, Sequence[Message]]:
        """Wait for messages, and return what came."""
        try:
            return self._received.get(timeout=seconds)
        except Empty:
            return time.monotonic(), ()

    def notes(self) -> Sequence[str]:
        """Return of whom nothing comes, and why."""
        return self._notes

    def close(self) -> None:
        """Leave the domains."""
        self._ended = True
        self._thread.join()
        for domain in self._domains:
            domain.close()


class _Domain:
    """One participant."""

    def __init__(self, domain: int, prefix: str) -> None:
        try:
            self._participant = participant_of(domain)
        except DDSException as failure:
            raise EddiError(problem("I010.domain", domain=domain, reason=failure)) from None
        self._prefix = prefix
        self._writers: Any = BuiltinDataReader(self._participant, BuiltinTopicDcpsPublication)
        self._gone = ReadCondition(self._writers, _GONE)
        self._classes = _classes()
        self._waiting = WaitSet(self._participant)
        self._conditions: dict[str, tuple[str, Any]] = {}  # topic -> its type, and when it has data
        kept = reading({"durability": "transient_local", "reliability": "reliable"}, _PARTICIPANTS)
        self._graphs = []  # what reads the names of nodes
        for size in _GID_BYTES:
            info = discovery_types(size).rmw_dds_common_ParticipantEntitiesInfo
            topic = Topic(self._participant, "ros_discovery_info", info)
            self._graphs.append(DataReader(self._participant, topic, kept))
        self._nodes: dict[bytes, str] = {}  # identity of a writer -> its node
        self._node_of: dict[int, str] = {}  # handle of a writer -> its node
        self._first: dict[int, float] = {}  # handle of a writer whose node is not known yet
        self._seen: set[str] = set()
        self._due = 0.0

    def receive(self, seconds: float) -> Iterator[Message]:
        if time.monotonic() >= self._due:
            self._due = time.monotonic() + _EVERY_S
            self._look()
        if not self._conditions:
            time.sleep(seconds)
            return
        if self._waiting.wait(duration(milliseconds=max(1, int(seconds * 1000)))):
            time.sleep(GATHER_S)
        now = time.monotonic()
        for topic, (type_, condition) in self._conditions.items():
            for sample in condition.reader.take(_BATCH) if condition.triggered else ():
                if sample.sample_info.valid_data:
                    handle = sample.sample_info.publication_handle
                    node = self._node(condition.reader, handle, now)
                    if node is not None:
                        yield Message(self._prefix + topic, type_, sample, now, node)

    def _node(self, reader: Any, writer: int, now: float) -> str | None:
        """Return the name of the node that a writer is of.

        Returns:
            Empty where the graph does not tell; ``None`` while it may still do so: a message that
            is believed under no name would be of a monitor that then falls silent.
        """
        if writer not in self._node_of:
            endpoint = reader.get_matched_publication_data(writer)
            name = self._nodes.get(endpoint.key.bytes, "") if endpoint is not None else ""
            if not name and now - self._first.setdefault(writer, now) < _GRACE_S:
                self._due = min(self._due, now + _SOON_S)
                return None
            self._node_of[writer] = self._prefix + name if name else ""
        return self._node_of[writer]

    def _look(self) -> None:
        """Learn the names of nodes, and read every topic that a monitor publishes by now.

        A topic is read from the second look on, when the name of its node is known.
        """
        for graph in self._graphs:
            for sample in graph.take(_MANY):
                if sample.sample_info.valid_data:  # of the other size, it cannot be read
                    self._learn(getattr(sample, "node_entities_info_seq", ()))
        self._writers.take(_MANY, self._gone)
        topics = {
            writer.topic_name[len(_PREFIX) :]: ros_type(writer.type_name)
            for writer in self._writers.read(_MANY)
        }
        for topic, type_ in topics.items():
            is_new = topic in self._seen and topic not in self._conditions
            if is_new and is_watched(topic, type_) and len(self._conditions) < 3 * MAX_MONITORS:
                read = Topic(self._participant, _PREFIX + topic, self._classes[type_])
                reader = DataReader(self._participant, read, reading({}, _DEPTH))
                condition = ReadCondition(reader, _ANY)
                self._waiting.attach(condition)
                self._conditions[topic] = (type_, condition)
        self._seen = {topic for topic in topics if topic.startswith("/")}

    def _learn(self, nodes: Iterable[Any]) -> None:
        for node in nodes:
            name = f"{node.node_namespace.rstrip('/')}/{node.node_name}"
            gids = (bytes(gid.data[:_GUID_BYTES]) for gid in node.writer_gid_seq)
            self._nodes.update(dict.fromkeys(gids, name))

    def notes(self) -> Iterator[str]:
        for topic, (type_, condition) in self._conditions.items():
            if condition.reader.get_requested_incompatible_qos_status().total_count:
                other = f"another definition of {type_}, or another quality of service"
                yield f"{self._prefix}{topic}: a publisher has {other}"

    def close(self) -> None:
        for _, condition in self._conditions.values():
            self._waiting.detach(condition)
        self._conditions.clear()
        del self._waiting, self._gone, self._writers, self._graphs, self._participant


def _classes() -> dict[str, Any]:
    """Return type -> class of cyclonedds, of all that is watched."""
    known = {name: ros2_fields(of) for name, of in ros2_messages({**known_messages()}).items()}
    watched = (*status_messages(), WHY, DIAGNOSTICS)
    texts = {
        name: ", ".join(f"{type_} {field}" for field, type_ in known[name].items())
        for top in watched
        for name in with_parts(top, known)
    }
    by_name = vars(message_classes(texts))
    classes = {name: by_name[name.replace("/", "_")] for name in watched}
    for name, cls in classes.items():
        if next(iter(known[name].values()), "") == "std_msgs/Header":
            _decode_changes_only(cls)
    return classes


def _decode_changes_only(cls: Any) -> None:
    """Let messages that are equal behind their stamp be one object: only new ones are decoded."""
    decode = cls.deserialize

    @lru_cache(_REMEMBERED)
    def decoded(head: bytes, rest: bytes, **more: object) -> Any:
        return decode(head + bytes(_BEHIND_STAMP - _BEFORE_STAMP) + rest, **more)

    def read(_: Any, data: bytes, /, **more: object) -> Any:
        return decoded(bytes(data[:_BEFORE_STAMP]), bytes(data[_BEHIND_STAMP:]), **more)

    cls.deserialize = classmethod(read)
