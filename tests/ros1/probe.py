"""A ROS node under /usr/bin/python3 that a test steers with JSON lines.

Commands on stdin, what happened on stdout; the test process itself never imports rospy.
"""

import importlib
import json
import os
import sys
import threading
import time

import genpy.message
import rospy

_lock = threading.Lock()
_publishers = {}
_repeats = {}


def say(**event):
    with _lock:
        sys.stdout.write(json.dumps(event) + "\n")
        sys.stdout.flush()


def message_class(name):
    package, kind = name.split("/")
    return getattr(importlib.import_module(package + ".msg"), kind)


def plain(value):
    if isinstance(value, genpy.Message):
        return {field: plain(getattr(value, field)) for field in value.__slots__}
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if isinstance(value, genpy.TVal):
        return value.to_sec()
    return value


def build(name, fields):
    message = message_class(name)()
    genpy.message.fill_message_args(message, [fields])
    return message


def subscribe(topic, kind):
    def received(message):
        say(event="message", topic=topic, t=time.monotonic(), data=plain(message))

    rospy.Subscriber(topic, message_class(kind), received, tcp_nodelay=True)


def publish(topic, kind, fields, latch=False, connected=False):
    if topic not in _publishers:
        _publishers[topic] = rospy.Publisher(topic, message_class(kind), queue_size=10, latch=latch)
    while connected and not _publishers[topic].get_num_connections():
        time.sleep(0.01)
    message = build(kind, fields)
    _publishers[topic].publish(message)
    say(event="published", topic=topic, t=time.monotonic())


def every(topic, kind, fields, hz, connected=True):
    """Publish again and again; first waits for a subscriber, so that bursts are counted."""
    publisher = _publishers.setdefault(
        topic, rospy.Publisher(topic, message_class(kind), queue_size=1000)
    )
    stop = _repeats[topic] = threading.Event()
    message = build(kind, fields)

    def run():
        while connected and not publisher.get_num_connections() and not stop.wait(0.01):
            pass
        say(event="connected", topic=topic, t=time.monotonic())
        due = time.monotonic()
        sent = 0
        while not stop.is_set():
            publisher.publish(message)
            sent += 1
            due += 1.0 / hz
            stop.wait(max(0.0, due - time.monotonic()))
        say(event="sent", topic=topic, count=sent)

    threading.Thread(target=run, daemon=True).start()


def stop(topic):
    _repeats.pop(topic).set()


def connections(topic):
    say(event="connections", topic=topic, count=_publishers[topic].get_num_connections())


def main():
    rospy.init_node(f"probe_{os.getpid()}", disable_signals=True)
    say(event="ready")
    commands = {f.__name__: f for f in (subscribe, publish, every, stop, connections)}
    for line in sys.stdin:
        command = json.loads(line)
        commands[command.pop("do")](**command)
    rospy.signal_shutdown("done")


if __name__ == "__main__":
    main()
