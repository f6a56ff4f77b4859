"""A DDS participant that a test steers with JSON lines, as ``tests/ros1/probe.py`` is a ROS node.

Commands on stdin, what happened on stdout.
"""

import json
import os
import sys
import threading
import time

from cyclonedds.core import InstanceState, ReadCondition, SampleState, ViewState, WaitSet
from cyclonedds.domain import DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration
from eddi_runtime.transports.dds.graph import discovery_types
from eddi_runtime.transports.dds.messages import OWN, message_classes

_lock = threading.Lock()
_writers, _repeats = {}, {}
_participant = DomainParticipant(int(os.environ["ROS_DOMAIN_ID"]))
_classes = {
    **vars(OWN),
    **vars(
        message_classes(
            {
                "std_msgs/Bool": "bool data",
                "std_msgs/String": "string data",
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


def say(**event):
    with _lock:
        sys.stdout.write(json.dumps(event) + "\n")
        sys.stdout.flush()


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
                    say(event="message", topic=topic, t=time.monotonic(), data=plain(sample))

    threading.Thread(target=run, daemon=True).start()


def writer(topic, kind, latch, connected, *promises, reliability=_RELIABLE):
    if topic not in _writers:
        keeps = _KEPT if latch else Policy.Durability.Volatile
        history = Policy.History.KeepLast(1 if latch else 1000)
        qos = Qos(reliability, keeps, history, *promises)
        _writers[topic] = DataWriter(_participant, topic_of(topic, kind), qos)
    while connected and not _writers[topic].get_publication_matched_status().current_count:
        time.sleep(0.01)
    return _writers[topic]


def built(make, fields):
    """Return a message; a map is the fields of a message in it."""
    makers = make.MAKERS
    values = {k: built(makers[k], v) if isinstance(v, dict) else v for k, v in fields.items()}
    return make(**values)


def publish(topic, kind, fields, latch=False, connected=False):
    message = built(_classes[kind.replace("/", "_")], fields)
    writer(topic, kind, latch, connected).write(message)
    say(event="published", topic=topic, t=time.monotonic())


def every(topic, kind, fields, hz, connected=True, best_effort=False, deadline=None, lease=None):
    """Publish again and again; what promises a deadline or a sign of life must keep that."""
    promises = [Policy.Deadline(duration(seconds=deadline))] if deadline else []
    if lease:
        promises.append(Policy.Liveliness.ManualByTopic(duration(seconds=lease)))
    message = built(_classes[kind.replace("/", "_")], fields)
    stop = _repeats[topic] = threading.Event()

    def run():
        reliability = Policy.Reliability.BestEffort if best_effort else _RELIABLE
        made = writer(topic, kind, False, connected, *promises, reliability=reliability)
        say(event="connected", topic=topic, t=time.monotonic())
        due, sent = time.monotonic(), 0
        while not stop.is_set():
            made.write(message)
            sent += 1
            due += 1.0 / hz
            stop.wait(max(0.0, due - time.monotonic()))
        say(event="sent", topic=topic, count=sent)

    threading.Thread(target=run, daemon=True).start()


def stop(topic):
    _repeats.pop(topic).set()


def main():
    say(event="ready")
    commands = {f.__name__: f for f in (subscribe, publish, every, stop)}
    for line in sys.stdin:
        command = json.loads(line)
        commands[command.pop("do")](**command)


if __name__ == "__main__":
    main()
