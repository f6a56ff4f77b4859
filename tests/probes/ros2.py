"""A node of rclpy that a test steers."""

import importlib
import os
import threading

import rclpy
from lifecycle_msgs.srv import ChangeState, GetState
from rclpy.qos import DurabilityPolicy, QoSProfile
from steered import heard, obey, published, repeat, say, wait_for

_publishers = {}
_KEPT = DurabilityPolicy.TRANSIENT_LOCAL


def message_class(name):
    package, kind = name.split("/")
    return getattr(importlib.import_module(package + ".msg"), kind)


def plain(value):
    if hasattr(value, "get_fields_and_field_types"):
        return {field: plain(getattr(value, field)) for field in value.get_fields_and_field_types()}
    if isinstance(value, bytes):
        return value[0]
    return [plain(one) for one in value] if isinstance(value, list) else value


def built(cls, fields):
    """Return a message; a map is the fields of a message in it."""
    of = {name: getattr(cls(), name).__class__ for name in fields}
    values = {k: built(of[k], v) if isinstance(v, dict) else v for k, v in fields.items()}
    return cls(**values)


def subscribe(topic, kind):
    def received(message):
        heard(topic, plain(message))

    qos = QoSProfile(depth=1000, durability=_KEPT)
    _node.create_subscription(message_class(kind), topic, received, qos)


def publisher(topic, kind, latch, connected):
    if topic not in _publishers:
        kept = QoSProfile(depth=1, durability=_KEPT)
        qos = kept if latch else QoSProfile(depth=1000)
        _publishers[topic] = _node.create_publisher(message_class(kind), topic, qos)
    wait_for(_publishers[topic].get_subscription_count, connected)
    return _publishers[topic]


def publish(topic, kind, fields, latch=False, connected=False):
    publisher(topic, kind, latch, connected).publish(built(message_class(kind), fields))
    published(topic)


def every(topic, kind, fields, hz, connected=True):
    message = built(message_class(kind), fields)
    begin = lambda _: publisher(topic, kind, False, connected)  # noqa: E731
    repeat(topic, hz, begin, lambda: _publishers[topic].publish(message))


def change(node, label):
    """Have a managed node make a transition."""
    request = ChangeState.Request()
    request.transition.label = label
    asked(ChangeState, f"{node}/change_state", request, lambda answer: answer.success)


def state(node):
    """Ask for the state of a managed node."""
    request = GetState.Request()
    asked(GetState, f"{node}/get_state", request, lambda answer: answer.current_state.label)


def asked(cls, service, request, of):
    client = _node.create_client(cls, service)
    if not client.wait_for_service(10.0):
        say(event="answered", answer=None)
        return
    future = client.call_async(request)
    future.add_done_callback(lambda done: say(event="answered", answer=of(done.result())))


if __name__ == "__main__":
    rclpy.init()
    _node = rclpy.create_node(f"probe_{os.getpid()}")
    threading.Thread(target=rclpy.spin, args=[_node], daemon=True).start()
    obey(subscribe, publish, every, change, state)
