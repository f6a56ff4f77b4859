"""The messages of ROS 2 graphs, over DDS; needs the wheel `cyclonedds`, and no ROS."""

from __future__ import annotations

import threading
import time
from collections import OrderedDict
from collections.abc import Collection, Iterable, Iterator, Sequence
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
from cyclonedds.domain import DomainParticipant
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration
from eddi_runtime.transports.dds.graph import discovery_types, reading
from eddi_runtime.transports.dds.messages import message_classes
from eddi_runtime.transports.dds.node import ros_type

from eddi_scaffold.common.problems import EddiError, problem
from eddi_scaffold.config.message_types import known_messages, ros2_fields, ros2_messages
from eddi_scaffold.platforms.dds import with_parts
from eddi_scaffold.watch.messages import (
    DIAGNOSTICS,
    GATHER_S,
    MAX_MONITORS,
    Message,
    heard,
    is_watched,
)

_PREFIX = "rt"
_EVERY_S = 1.0
_SOON_S = 0.2
_WAIT_S = 0.1
_GRACE_S = 2.0
"""Within which the graph tells the node of a writer, if it does."""
_DEPTH = 10
_PARTICIPANTS = 10_000
"""Each says once of which nodes it is."""
_BATCH = 100
_MANY = 100_000
_STAMP = 12
"""Bytes of a message before the frame of its header: encapsulation and stamp."""
_REMEMBERED = 512
_GID_BYTES = (24, 16)
"""Of an identity on the graph up to Humble, and of later releases."""
_GUID_BYTES = 16
_DISCOVERY = "ros_discovery_info"
_DEFINITION = 24
"""Number of the policy that definitions are alike."""
_ANY = ViewState.Any | InstanceState.Any | SampleState.Any


class DdsGraphs:
    """What the monitors in some domains publish, from now on; times are of the monotonic clock.

    Args:
        domains: their ids; with several, a topic has ``/domain<id>`` before its name.

    Raises:
        EddiError: there is no such domain, or no network (I010).
    """

    def __init__(self, domains: Collection[int]) -> None:
        several = len(domains) > 1
        self._domains = [
            _Domain(domain, f"/domain{domain}" if several else "") for domain in domains
        ]
        self._came: SimpleQueue[tuple[float, Sequence[Message]]] = SimpleQueue()
        self._trouble: tuple[str, ...] = ()
        self._notes: tuple[str, ...] = ()
        self._ended = False
        # A thread of its own: Ctrl-C while DDS calls back into Python would be an error of DDS.
        self._thread = threading.Thread(target=self._run, name="dds", daemon=True)
        self._thread.start()

    def _run(self) -> None:
        while not self._ended:
            self._step()

    def _step(self) -> None:
        wait = _WAIT_S / len(self._domains)
        try:
            found = [message for domain in self._domains for message in domain.receive(wait)]
            self._notes = tuple(note for domain in self._domains for note in domain.notes())
        except Exception as failure:  # noqa: BLE001 - whatever a driver raises
            self._trouble = (f"dds: {type(failure).__name__}: {failure}",)
            time.sleep(_WAIT_S)
            return
        if found:
            self._came.put((time.monotonic(), found))

    def receive(self, seconds: float) -> tuple[float, Sequence[Message]]:
        """Wait for messages, and return what came."""
        try:
            return self._came.get(timeout=seconds)
        except Empty:
            return time.monotonic(), ()

    def notes(self) -> Sequence[str]:
        """Return of whom nothing comes, and why."""
        return [*self._trouble, *self._notes]

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
            self._participant: Any = DomainParticipant(domain)
        except DDSException as failure:
            raise EddiError(problem("I010.domain", domain=domain, reason=failure)) from None
        self._shown = prefix
        self._known: Any = BuiltinDataReader(self._participant, BuiltinTopicDcpsPublication)
        self._gone = ReadCondition(
            self._known,
            ViewState.Any
            | SampleState.Any
            | InstanceState.NotAliveDisposed
            | InstanceState.NotAliveNoWriters,
        )
        self._classes = _classes()
        self._waiting = WaitSet(self._participant)
        self._conditions: dict[str, tuple[str, Any]] = {}
        self._told = [self._discovery(size) for size in _GID_BYTES]
        self._nodes: dict[bytes, str] = {}  # identity of a writer -> its node
        self._node_of: dict[int, str] = {}  # handle of a writer -> its node
        self._first: dict[int, float] = {}  # handle of a writer whose node is not known yet
        self._seen: set[str] = set()
        self._due = 0.0

    def _discovery(self, size: int) -> Any:
        """Return what reads the names of nodes, of releases whose identities have that size."""
        info = discovery_types(size).rmw_dds_common_ParticipantEntitiesInfo
        kept = reading({"durability": "transient_local", "reliability": "reliable"}, _PARTICIPANTS)
        return DataReader(self._participant, Topic(self._participant, _DISCOVERY, info), kept)

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
            if condition.triggered:
                for sample in condition.reader.take(_BATCH):
                    if sample.sample_info.valid_data:
                        handle = sample.sample_info.publication_handle
                        node = self._node(condition.reader, handle, now)
                        if node is not None:
                            yield Message(self._shown + topic, type_, sample, now, node)

    def _node(self, reader: Any, publication: int, now: float) -> str | None:
        """Return the name of the node that a writer is of.

        Returns:
            Empty where the graph does not tell; ``None`` while it may still do so: a message that
            is believed under no name would be of a monitor that then falls silent.
        """
        if publication in self._node_of:
            return self._node_of[publication]
        endpoint = reader.get_matched_publication_data(publication)
        name = self._nodes.get(endpoint.key.bytes, "") if endpoint is not None else ""
        if not name and now - self._first.setdefault(publication, now) < _GRACE_S:
            self._due = min(self._due, now + _SOON_S)
            return None
        self._first.pop(publication, None)
        if len(self._node_of) + len(self._first) > _MANY:  # who comes and goes for years
            self._node_of.clear()
            self._first.clear()
        self._node_of[publication] = self._shown + name if name else ""
        return self._node_of[publication]

    def _look(self) -> None:
        """Learn the names of nodes, and read every topic that a monitor publishes by now.

        A topic is read from the second look on, when the name of its node is known.
        """
        for sample in (sample for one in self._told for sample in one.take(_MANY)):
            if sample.sample_info.valid_data:  # of the other size, it cannot be read
                self._learn(getattr(sample, "node_entities_info_seq", ()))
        self._known.take(_MANY, self._gone)
        seen = [(one.topic_name[len(_PREFIX) :], one.type_name) for one in self._known.read(_MANY)]
        for topic, name in seen:
            type_ = ros_type(name)
            is_new = topic in self._seen and topic not in self._conditions
            if is_new and is_watched(topic, type_) and len(self._conditions) < 3 * MAX_MONITORS:
                self._read(topic, type_)
        self._seen = {topic for topic, _ in seen if topic.startswith("/")}

    def _learn(self, nodes: Iterable[Any]) -> None:
        for node in nodes:
            name = f"{node.node_namespace.rstrip('/')}/{node.node_name}"
            gids = (bytes(one.data[:_GUID_BYTES]) for one in node.writer_gid_seq)
            self._nodes.update(dict.fromkeys(gids, name))
            while len(self._nodes) > _MANY:  # who comes and goes for years
                del self._nodes[next(iter(self._nodes))]

    def _read(self, topic: str, type_: str) -> None:
        cls = self._classes[type_]
        of = Topic(self._participant, _PREFIX + topic, cls)
        reader = DataReader(self._participant, of, reading({}, _DEPTH))
        condition = ReadCondition(reader, _ANY)
        self._waiting.attach(condition)
        self._conditions[topic] = (type_, condition)

    def notes(self) -> Iterator[str]:
        for topic, (type_, condition) in self._conditions.items():
            status = condition.reader.get_requested_incompatible_qos_status()
            if status.total_count and status.last_policy_id == _DEFINITION:
                yield f"{self._shown}{topic}: a publisher has another definition of {type_}"
            elif status.total_count:
                yield f"{self._shown}{topic}: a publisher offers another quality of service"

    def close(self) -> None:
        for _, condition in self._conditions.values():
            self._waiting.detach(condition)
        self._conditions.clear()
        del self._waiting
        del self._gone
        del self._known
        del self._told
        del self._participant


def _classes() -> dict[str, Any]:
    """Return type -> class of cyclonedds, of all that is watched."""
    known = {name: ros2_fields(of) for name, of in ros2_messages({**known_messages()}).items()}
    wanted = (*heard(), DIAGNOSTICS)
    names = dict.fromkeys(part for one in wanted for part in with_parts(one, known))
    texts = {
        name: ", ".join(f"{of} {field}" for field, of in known[name].items()) for name in names
    }
    made = vars(message_classes(texts))
    found = {one: made[one.replace("/", "_")] for one in wanted}
    for one, cls in found.items():
        if next(iter(known[one].values()), "") == "std_msgs/Header":
            _remember(cls)
    return found


def _remember(cls: Any) -> None:
    """Let messages that are equal behind their stamp be one object: only new ones are decoded."""
    decode = cls.deserialize
    last: OrderedDict[bytes, Any] = OrderedDict()

    def read(_: Any, data: bytes, /, **more: object) -> Any:
        key = bytes(data[_STAMP:])
        if key not in last:
            if len(last) >= _REMEMBERED:
                last.popitem(last=False)
            last[key] = decode(data, **more)
        else:
            last.move_to_end(key)
        return last[key]

    cls.deserialize = classmethod(read)
