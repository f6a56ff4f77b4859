"""The participant of a process in a DDS domain: what it reads and writes, and who else is there.

No listener is set anywhere: they run on threads of DDS, and a process that ends with one may
crash. One thread waits for data in place of them.
"""

from __future__ import annotations

import contextlib
import gc
import os
import threading
import time
from types import SimpleNamespace
from typing import Any, Callable, Mapping, NamedTuple

from cyclonedds import core
from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsPublication
from cyclonedds.domain import DomainParticipant
from cyclonedds.pub import DataWriter, Publisher
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader, Subscriber
from cyclonedds.topic import Topic
from cyclonedds.util import duration

from ...node.report import Reason, offer
from ...node.start import LOG, StartError
from ...node.topics import reading_qos, writing_qos
from .messages import message_classes

Receive = Callable[[Any, bool], None]
"""Takes a message (or ``Unreadable``), and whether it may be of any age."""

_PREFIX = "rt"
_BATCH = 100
_MANY = 100_000
_WAIT = duration(milliseconds=200)
_GID_BYTES = {"humble": 24}
_ANY = core.ViewState.Any | core.InstanceState.Any | core.SampleState.Any
_RELIABILITIES = {
    "reliable": Policy.Reliability.Reliable(duration(milliseconds=100)),
    "best_effort": Policy.Reliability.BestEffort,
}
_DURABILITIES = {
    "transient_local": Policy.Durability.TransientLocal,
    "volatile": Policy.Durability.Volatile,
}
_REFUSALS = {
    2: offer("volatile", "transient_local"),
    4: offer("no deadline or a longer one", "one as asked for"),
    11: offer("best_effort", "reliable"),
    24: Reason("type", "another definition of the message comes"),
}
_OTHER_QOS = offer("another QoS", "that asked for")
_DISCOVERY = "ros_discovery_info"
_BY_NAME = (
    "<CycloneDDS><Domain><Compatibility><IgnoreTypeInformation>1.15</IgnoreTypeInformation>"
    "</Compatibility></Domain></CycloneDDS>"
)
"""Types of Fast DDS, vendor 1.15, match by name: what it says of lists matches no type here."""


class Publication(NamedTuple):
    """One writer of a ROS topic, anywhere on the graph."""

    topic: str  # full name
    type: str  # as DDS calls it
    deadline: float | None  # seconds between two messages that it promises, if it does


class Reader:
    """What reads a topic, and who takes its messages."""

    def __init__(self, reader: Any, receive: Receive) -> None:
        self.reader, self._receive = reader, receive
        self._greeted: set[int] = set()

    def take(self) -> None:
        """Hand over all that has arrived; never raises: who waits no more receives no more."""
        count = _BATCH
        try:
            while count == _BATCH:
                samples = self.reader.take(_BATCH)
                count = len(samples)
                for sample in samples:
                    writer = sample.sample_info.publication_handle
                    if sample.sample_info.valid_data:  # else its writer or its data went
                        self._receive(sample, writer not in self._greeted and self._keeps(writer))
                        self._greeted.add(writer)
                    else:
                        self._greeted.discard(writer)
        except Exception as error:  # noqa: BLE001 - whatever a driver raises
            LOG.error("dds: %s: %s", type(error).__name__, error)
            time.sleep(0.1)

    def _keeps(self, writer: int) -> bool:
        """Return whether a writer keeps messages for who comes later, such as the first one."""
        with contextlib.suppress(Exception):
            endpoint = self.reader.get_matched_publication_data(writer)
            return Policy.Durability.TransientLocal in endpoint.qos
        return True


def participant_of(domain: int, qos: Qos | None = None) -> Any:
    """Return a new participant; ``CYCLONEDDS_URI`` has the last word on its network."""
    configured = os.environ.get("CYCLONEDDS_URI", "")
    if not configured.startswith(_BY_NAME):
        os.environ["CYCLONEDDS_URI"] = f"{_BY_NAME},{configured}".rstrip(",")
    return DomainParticipant(domain, qos)


class Graph:
    """A participant that is a node of ROS 2; StartError where there is no domain, or no network.

    ``distro``: up to Humble, identities are longer. ``partition``: of topics, empty for ROS 2's.
    """

    def __init__(
        self, domain: int, namespace: str, name: str, distro: str, partition: str = ""
    ) -> None:
        try:
            participant = participant_of(domain, Qos(Policy.Userdata(b"enclave=/;")))
        except core.DDSException as error:
            raise StartError(f"no participant in domain {domain}: {error}") from error
        self._participant: Any = participant
        self._node = (namespace, name)
        self._types = discovery_types(_GID_BYTES.get(distro, 16))
        apart = Qos(Policy.Partition([partition])) if partition else None
        self._publisher = Publisher(participant, apart)
        self._subscriber = Subscriber(participant, apart)
        self._writers: dict[str, Any] = {}
        self._readers: dict[str, Reader] = {}
        self._known: Any = BuiltinDataReader(participant, BuiltinTopicDcpsPublication)
        gone = core.InstanceState.NotAliveDisposed | core.InstanceState.NotAliveNoWriters
        gone |= core.ViewState.Any | core.SampleState.Any
        self._gone = core.ReadCondition(self._known, gone)
        self._guard = core.GuardCondition(participant)
        self._stopped = False
        self._use = threading.Lock()
        """Held while something asks DDS: what is asked must not be deleted meanwhile."""
        self._thread = threading.Thread(target=self._run, name="dds", daemon=True)
        info = Topic(participant, _DISCOVERY, self._types.rmw_dds_common_ParticipantEntitiesInfo)
        self._info: Any = DataWriter(participant, info, writing({}, 1))

    def writer(self, topic: str, cls: Any, qos: Qos) -> Callable[[Any], None]:
        self._writers[topic] = DataWriter(self._publisher, self._topic(topic, cls), told(cls, qos))

        def write(message: Any) -> None:
            with self._use:
                if not self._stopped:  # looked up each time, so that ``close`` deletes it
                    self._writers[topic].write(message)

        return write

    def reader(self, topic: str, cls: Any, receive: Receive, qos: Qos) -> None:
        """Read a ROS topic; before ``start``."""
        made = DataReader(self._subscriber, self._topic(topic, cls), told(cls, qos))
        self._readers[topic] = Reader(made, receive)

    def _topic(self, topic: str, cls: Any) -> Any:
        return Topic(self._participant, _PREFIX + topic, cls)

    def start(self) -> None:
        self._tell([reader.reader for reader in self._readers.values()], [*self._writers.values()])
        self._thread.start()

    def _tell(self, readers: list[Any], writers: list[Any]) -> None:
        types, (namespace, name) = self._types, self._node
        node = types.rmw_dds_common_NodeEntitiesInfo(
            node_namespace=namespace,
            node_name=name,
            reader_gid_seq=[self._gid(reader) for reader in readers],
            writer_gid_seq=[self._gid(writer) for writer in writers],
        )
        info = types.rmw_dds_common_ParticipantEntitiesInfo(
            gid=self._gid(self._participant),
            node_entities_info_seq=[node] if readers or writers else [],
        )
        self._info.write(info)

    def _gid(self, entity: Any) -> Any:
        made = self._types.rmw_dds_common_Gid()
        made.data = entity.get_guid().bytes.ljust(len(made.data), b"\0")
        return made

    def _run(self) -> None:
        waiting = core.WaitSet(self._participant)
        conditions = [core.ReadCondition(reader.reader, _ANY) for reader in self._readers.values()]
        for condition in (*conditions, self._guard):
            waiting.attach(condition)
        while not self._stopped:
            waiting.wait(_WAIT)
            for reader in self._readers.values():
                reader.take()
        for condition in (*conditions, self._guard):
            waiting.detach(condition)

    def publications(self) -> list[Publication]:
        with self._use:
            if self._stopped:
                return []
            self._known.take(_MANY, self._gone)  # else the dead are kept, and look like the living
            seen = self._known.read(_MANY)
        living = core.InstanceState.Alive
        alive = [writer for writer in seen if writer.sample_info.instance_state == living]
        names = [writer.topic_name[len(_PREFIX) :] for writer in alive]
        pairs = [(writer, name) for writer, name in zip(alive, names) if name.startswith("/")]
        return [Publication(name, of.type_name, _deadline(of.qos)) for of, name in pairs]

    def listening(self, topic: str) -> tuple[bool, bool, Reason | None]:
        """Return whether a publication is listened to, whether it lives, and what is unfit."""
        with self._use:
            if self._stopped:
                return False, False, None
            reader = self._readers[topic].reader
            unfit = reader.get_requested_incompatible_qos_status()
            matched = reader.get_subscription_matched_status().current_count > 0
            alive = bool(reader.get_liveliness_changed_status().alive_count)
            del reader  # before its participant: see `close`
        refusal = _REFUSALS.get(unfit.last_policy_id, _OTHER_QOS)
        reason = refusal if unfit.total_count else None
        return matched, alive, reason

    def close(self) -> None:
        """Leave the graph: all is deleted in order, so that no thread of DDS meets a ghost."""
        with self._use:  # who asks now has its answer first; who asks later has none
            self._stopped = True
        with contextlib.suppress(core.DDSException, RuntimeError):
            self._guard.set(True)
            self._thread.join()
        with contextlib.suppress(Exception):
            self._tell([], [])
        self._readers.clear()
        self._writers.clear()
        for name in ("gone", "known", "guard", "info", "publisher", "subscriber", "participant"):
            delattr(self, f"_{name}")
        gc.collect()


def _deadline(qos: Any) -> float | None:
    promised = None if qos is None else qos[Policy.Deadline]
    if promised is None or not 0 < promised.deadline < duration(infinite=True):
        return None
    return float(promised.deadline / 1e9)


def discovery_types(gid_bytes: int) -> SimpleNamespace:
    """Return the messages by which participants name their nodes."""
    package = "rmw_dds_common/"
    nodes = "string node_namespace, string node_name"
    gids = f"{package}Gid[] reader_gid_seq, {package}Gid[] writer_gid_seq"
    return message_classes(
        {
            f"{package}Gid": f"uint8[{gid_bytes}] data",
            f"{package}NodeEntitiesInfo": f"{nodes}, {gids}",
            f"{package}ParticipantEntitiesInfo": f"{package}Gid gid,"
            f" {package}NodeEntitiesInfo[] node_entities_info_seq",
        }
    )


def reading(requested: Mapping[str, Any], depth: int) -> Qos:
    """Return how evidence is read, of every publication: see :func:`reading_qos`."""
    cdr = Policy.DataRepresentation(use_cdrv0_representation=True, use_xcdrv2_representation=False)
    return _qos(reading_qos(requested, depth), cdr)


def writing(requested: Mapping[str, Any], depth: int) -> Qos:
    """Return how results are written: see :func:`writing_qos`."""
    return _qos(writing_qos(requested, depth), Policy.WriterDataLifecycle(autodispose=False))


def told(cls: Any, qos: Qos) -> Qos:
    """Return a quality of service with the hash of the type, which ROS 2 reads since Iron."""
    return Qos(Policy.Userdata(f"typehash={cls.HASH};".encode()), base=qos) if cls.HASH else qos


def _qos(wanted: Mapping[str, Any], *more: Any) -> Qos:
    reliability, durability = wanted["reliability"], wanted["durability"]
    policies = [_RELIABILITIES[reliability], _DURABILITIES[durability], *more]
    for name, policy in (("deadline", Policy.Deadline), ("lifespan", Policy.Lifespan)):
        policies += [policy(duration(seconds=wanted[name]))] if name in wanted else []
    return Qos(Policy.History.KeepLast(wanted["depth"]), *policies)
