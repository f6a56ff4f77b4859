"""Checks of the parts that need rospy's modules but no graph; run by test_parts.py.

Runs under /usr/bin/python3, which has rospy but perhaps no pytest: hence plain functions.
"""

# ruff: noqa: PT017 - no pytest here
import time
from io import BytesIO

import eddi_messages.msg
import rospy
import std_msgs.msg
from eddi_runtime.inputs import UNKNOWN_AGE
from eddi_runtime.node.outputs import MessageError
from eddi_runtime.node.receipts import Receipts
from eddi_runtime.transports.ros1 import Input
from eddi_runtime.transports.ros1.node import Callback, converter


def check_classes_of_genpy_are_filled_and_checked():
    """What they are made of is tested with plain classes; here that genpy's are such classes."""
    one = {"id": "G", "verdict": 2, "missing": ["E"]}
    fields = {"model_id": "M", "model_digest": "d", "accepted": []}
    convert = converter(eddi_messages.msg)
    message = convert.message(
        ("ConSertStatus", {**fields, "guarantees": [("GuaranteeStatus", one)]})
    )
    assert message.guarantees[0].missing == ["E"]
    assert message.header.stamp.to_sec() > 1e9
    message.serialize(BytesIO())
    try:
        convert.message(("ConSertOutput", {"guarantees": [("GuaranteeStatus", one)]}))
    except MessageError as error:
        assert "eddi_messages/Guarantee expected" in str(error)
    else:
        raise AssertionError("another message inside was accepted")


def check_no_message_is_skipped():
    source = Input("sample", "/sample", std_msgs.msg.Bool, every_message=True)
    slots = Receipts([source], lambda: None)
    receive = Callback("sample", slots)
    assert slots.taken() == ({}, {"sample": []})
    for value in (True, False, True):
        receive(std_msgs.msg.Bool(value))
    receipts, new = slots.taken()
    assert [message.data for message in new["sample"]] == [True, False, True]
    assert receipts["sample"].message is new["sample"][-1]
    assert slots.taken() == (receipts, {"sample": []})
    for _ in range(1005):
        receive(std_msgs.msg.Bool(False))
    assert slots.dropped() == "5 messages of sample were dropped"
    assert len(slots.taken()[1]["sample"]) == 1000


def check_the_age_of_a_latched_message():
    def received(message, header):
        message._connection_header = header
        receive(message)
        return slots.latest()["sample"]

    slots = Receipts([], lambda: None)
    receive = Callback("sample", slots)
    latching, other = {"callerid": "/a", "latching": "1"}, {"callerid": "/b", "latching": "0"}
    first = received(std_msgs.msg.Bool(True), latching)
    assert first.latched
    assert first.age_at(first.at + 1.0) == UNKNOWN_AGE
    assert not received(std_msgs.msg.Bool(True), latching).latched
    assert not received(std_msgs.msg.Bool(True), other).latched
    rospy.rostime.set_rostime_initialized(True)
    for made, low, high in ((-2.0, 2.0, 3.0), (60.0, UNKNOWN_AGE, UNKNOWN_AGE)):
        message = eddi_messages.msg.ConSertStatus()
        message.header.stamp = rospy.Time.from_sec(time.time() + made)
        stamped = received(message, dict(latching))
        assert low <= stamped.age_at(stamped.at) <= high
    assert received(eddi_messages.msg.ConSertStatus(), dict(latching)).latched


if __name__ == "__main__":
    for name, check in sorted(globals().items()):
        if name.startswith("check_"):
            check()
            print("passed", name)
