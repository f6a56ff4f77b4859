"""A ROS node under /usr/bin/python3 that a test steers."""

import importlib
import os

import genpy.message
import rospy
from steered import heard, obey, published, repeat, wait_for

_publishers = {}


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
    """Hear messages of a kind, or of that which their publisher names."""

    def received(message):
        if kind is None:
            raw, message = message, message_class(message._connection_header["type"])()
            message.deserialize(raw._buff)
        heard(topic, plain(message))

    made = message_class(kind) if kind else rospy.AnyMsg
    rospy.Subscriber(topic, made, received, tcp_nodelay=True)


def publisher(topic, kind, **more):
    if topic not in _publishers:
        _publishers[topic] = rospy.Publisher(topic, message_class(kind), **more)
    return _publishers[topic]


def publish(topic, kind, fields, latch=False, connected=False):
    made = publisher(topic, kind, queue_size=10, latch=latch)
    wait_for(made.get_num_connections, connected)
    made.publish(build(kind, fields))
    published(topic)


def every(topic, kind, fields, hz, connected=True):
    made, message = publisher(topic, kind, queue_size=1000), build(kind, fields)
    begin = lambda ended: wait_for(made.get_num_connections, connected, ended)  # noqa: E731
    repeat(topic, hz, begin, lambda: made.publish(message))


if __name__ == "__main__":
    rospy.init_node(f"probe_{os.getpid()}", disable_signals=True)
    obey(subscribe, publish, every)
    rospy.signal_shutdown("done")
