"""A DDS participant that a test steers."""

import os
import threading

from cyclonedds.core import InstanceState, ReadCondition, SampleState, ViewState, WaitSet
from cyclonedds.domain import DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration
from eddi_runtime.transports.dds.graph import discovery_types
from eddi_runtime.transports.dds.messages import OWN, message_classes
from steered import heard, obey, published, repeat, wait_for

_writers = {}
_participant = DomainParticipant(int(os.environ["ROS_DOMAIN_ID"]))
_classes = {
    **vars(OWN),
    **vars(
        message_classes(
            {
                "std_msgs/Bool": "bool data",
                "std_msgs/String": "string data",
                "std_msgs/Float32": "float32 data",
                "std_msgs/Float64": "float64 data",
                "eddi_messages/Guarantee": "string id, bool active",
                "eddi_messages/ConSertOutput": "eddi_messages/Guarantee[] guarantees",
            }
        )
    ),
    **vars(discovery_types(24)),
    # the right name, another definition
    "other_Bool": message_classes({"std_msgs/Bool": "uint8 data"}).std_msgs_Bool,
}
_RELIABLE = Policy.Reliability.Reliable(duration(seconds=1))
_KEPT = Policy.Durability.TransientLocal


def plain(value):
    if hasattr(value, "MAKERS"):
        return {field: plain(getattr(value, field)) for field in value.MAKERS}
    if isinstance(value, bytes):
        return value.hex()
    return [plain(one) for one in value] if isinstance(value, list) else value


def topic_of(topic, kind):
    name = "rt" + topic if topic.startswith("/") else topic
    return Topic(_participant, name, _classes[kind.replace("/", "_")])


def subscribe(topic, kind):
    reader = DataReader(_participant, topic_of(topic, kind), Qos(_RELIABLE, _KEPT))
    waiting = WaitSet(_participant)
    any_state = ViewState.Any | InstanceState.Any | SampleState.NotRead
    waiting.attach(ReadCondition(reader, any_state))

    def run():
        while True:
            waiting.wait(duration(seconds=1))
            for sample in reader.take(100):
                if sample.sample_info.valid_data:
                    heard(topic, plain(sample))

    threading.Thread(target=run, daemon=True).start()


def writer(topic, kind, latch, connected, *promises, reliability=_RELIABLE):
    if topic not in _writers:
        keeps = _KEPT if latch else Policy.Durability.Volatile
        history = Policy.History.KeepLast(1 if latch else 1000)
        qos = Qos(reliability, keeps, history, *promises)
        _writers[topic] = DataWriter(_participant, topic_of(topic, kind), qos)
    wait_for(lambda: _writers[topic].get_publication_matched_status().current_count, connected)
    return _writers[topic]


def built(make, fields):
    """Return a message; a map is the fields of a message in it."""
    makers = make.MAKERS
    values = {k: built(makers[k], v) if isinstance(v, dict) else v for k, v in fields.items()}
    return make(**values)


def publish(topic, kind, fields, latch=False, connected=False):
    message = built(_classes[kind.replace("/", "_")], fields)
    writer(topic, kind, latch, connected).write(message)
    published(topic)


def every(topic, kind, fields, hz, connected=True, best_effort=False, deadline=None, lease=None):
    """Publish again and again; what promises a deadline or a sign of life must keep that."""
    promises = [Policy.Deadline(duration(seconds=deadline))] if deadline else []
    if lease:
        promises.append(Policy.Liveliness.ManualByTopic(duration(seconds=lease)))
    message = built(_classes[kind.replace("/", "_")], fields)
    reliability = Policy.Reliability.BestEffort if best_effort else _RELIABLE

    def begin(_):
        writer(topic, kind, False, connected, *promises, reliability=reliability)

    repeat(topic, hz, begin, lambda: _writers[topic].write(message))


if __name__ == "__main__":
    obey(subscribe, publish, every)
