"""Checks of the parts that need rospy's modules but no graph; run by test_parts.py.

Runs under /usr/bin/python3, which has rospy but perhaps no pytest: hence plain functions.
"""

# ruff: noqa: ICN001, PT017 - no pytest here, and numpy is looked for by its name
import threading
import time

import eddi_messages.msg
import rospy
import std_msgs.msg
from eddi_runtime.inputs import UNKNOWN_AGE
from eddi_runtime.node import health, schedule, settings
from eddi_runtime.node.conversion import MessageError
from eddi_runtime.node.outputs import check_outputs as refuse_outputs
from eddi_runtime.node.outputs import picked
from eddi_runtime.ros1 import Input, Output
from eddi_runtime.transports.ros1 import subscriptions
from eddi_runtime.transports.ros1.conversion import converter


def refused(function, *words):
    try:
        function()
    except MessageError as error:
        assert all(word in str(error) for word in words), error
    else:
        raise AssertionError(f"not refused: {words}")


def status(**changed):
    one = ("GuaranteeStatus", {"id": "G", "verdict": 2, "missing": ["E"], **changed})
    fields = {"model_id": "M", "model_digest": "d", "guarantees": [one], "accepted": []}
    return "ConSertStatus", fields


def check_messages_are_filled_completely_and_checked():
    convert = converter(eddi_messages.msg)
    message = convert.message(status())
    assert message.guarantees[0].missing == ["E"]
    assert message.header.stamp.to_sec() > 1e9
    wrong = (("verdict", -1), ("verdict", 256), ("verdict", True), ("verdict", 1.0))
    wrong += (("id", None), ("id", b"G"), ("missing", "E"), ("missing", [None]), ("missing", None))
    for field, value in wrong:
        refused(lambda f=field, v=value: convert.message(status(**{f: v})), f"Status.{field}")
    refused(lambda: convert.message(status(surplus=1)), "GuaranteeStatus", "surplus")
    refused(lambda: convert.message(("Nothing", {})), "Nothing", "eddi_messages")
    refused(lambda: convert.message(("Guarantee", {"id": "G"})), "active", "rebuild")
    for value in (None, 1, "True", float("nan")):
        tree = ("Guarantee", {"id": "G", "active": value})
        refused(lambda t=tree: convert.message(t), "Guarantee.active", "bool expected")
    plain = (
        "ConSertOutput",
        {"guarantees": [("GuaranteeStatus", status()[1]["guarantees"][0][1])]},
    )
    refused(lambda: convert.message(plain), "ConSertOutput.guarantees")


class Beside:
    """A monitor that says more than its result."""

    def status_message(self):
        return "ConSertOutput", {"guarantees": [("Guarantee", {"id": "H", "active": False})]}


def check_one_value_of_a_message_is_published_alone():
    convert = converter(eddi_messages.msg)
    tree = ("ConSertOutput", {"guarantees": [("Guarantee", {"id": "G", "active": True})]})
    field = ("guarantees", ("id", "G"), "active")
    output = Output("g", "/g", std_msgs.msg.Bool, field=field)
    first = output._replace(field=("guarantees", 0, "active"))
    for one in (output, first):
        assert picked(convert.message(tree), one).data is True
        refuse_outputs(convert, tree, Beside(), [one])
    other = output._replace(field=("guarantees", ("id", "H"), "active"))
    refused(lambda: refuse_outputs(convert, tree, Beside(), [other]), "/g", "H")
    refuse_outputs(convert, tree, Beside(), [other._replace(of="status")])
    refused(lambda: refuse_outputs(convert, tree, Beside(), [output._replace(field=("no",))]), "no")


def check_messages_beside_the_result_have_topics_of_their_own():
    convert = converter(eddi_messages.msg)
    fitting, wrong = eddi_messages.msg.ConSertOutput, eddi_messages.msg.Guarantee
    row = Output("g", "/g", fitting, of="status")
    old = Output("g", "/g", fitting, "/g/status", fitting)
    for output in (row, old):
        refuse_outputs(convert, None, Beside(), [output])
    other = old._replace(status_type=wrong)
    refused(lambda: refuse_outputs(convert, None, Beside(), [other]), "carries", "Guarantee")
    unknown = row._replace(of="evidence")
    refused(lambda: refuse_outputs(convert, None, Beside(), [unknown]), "no message 'evidence'")


def check_a_step_gives_several_messages_or_none():
    convert = converter(eddi_messages.msg)
    trees = [("Guarantee", {"id": name, "active": False}) for name in "AB"]
    assert [message.id for message in convert.messages(trees)] == ["A", "B"]
    assert convert.messages(None) is None


def check_no_message_is_skipped():
    slots = subscriptions.Subscriptions(lambda: None)
    source = Input("sample", "/sample", std_msgs.msg.Bool, every_message=True)
    slot = subscriptions._Slot(source, slots._lock, lambda: None)
    slots._slots["sample"] = slot
    assert slots.new_messages() == {"sample": []}
    for value in (True, False, True):
        slot.receive(std_msgs.msg.Bool(value))
    assert [message.data for message in slots.new_messages()["sample"]] == [True, False, True]
    assert slots.new_messages() == {"sample": []}
    assert slots.receipts()["sample"].message.data is True
    for _ in range(1005):
        slot.receive(std_msgs.msg.Bool(False))
    assert slots.dropped() == {"sample": 5}
    assert len(slots.new_messages()["sample"]) == 1000


def check_the_age_of_a_latched_message():
    def received(message, header):
        message._connection_header = header
        slot.receive(message)
        return slots.receipts()["sample"]

    slots = subscriptions.Subscriptions(lambda: None)
    slot = subscriptions._Slot(Input("sample", "/s", std_msgs.msg.Bool), slots._lock, lambda: None)
    slots._slots["sample"] = slot
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


def check_numbers():
    convert = converter(std_msgs.msg)
    assert convert.message(("Float64", {"data": 3})).data == 3.0
    assert convert.message(("Float32", {"data": float("inf")})).data == float("inf")
    for name, value in (("Float32", 1e39), ("Float64", "1"), ("Float64", True), ("Int8", 128)):
        tree = (name, {"data": value})
        refused(lambda t=tree: convert.message(t), name)
    try:
        import numpy
    except ImportError:
        return
    assert convert.message(("Int8", {"data": numpy.int64(5)})).data == 5
    assert type(convert.message(("Bool", {"data": numpy.bool_(1)})).data) is bool
    assert type(convert.message(("Float64", {"data": numpy.float32(0.5)})).data) is float


def check_late_steps_are_counted_and_not_made_up():
    grid = schedule.Schedule(0.1, on_change=False)
    grid.start(0.0)
    grid.stepped(0.1, 0.12)
    assert round(grid.wait_s(0.12), 6) == 0.08
    grid.stepped(0.2, 0.55)
    assert grid.overruns == 3  # 0.3, 0.4 and 0.5 have passed
    assert round(grid.wait_s(0.55), 6) == 0.05
    early = schedule.Schedule(2.0, on_change=True)
    early.start(0.0)
    early.stepped(0.5, 0.6)
    assert round(early.wait_s(0.6), 6) == 1.9
    assert early.overruns == 0


def check_many_wakes_are_one():
    waker = schedule.Waker()
    assert not waker.wait(0.01)
    for _ in range(3):
        waker.wake()
    assert waker.wait(0.0)
    assert not waker.wait(0.0)
    threading.Timer(0.05, waker.wake).start()
    started = time.monotonic()
    assert waker.wait(5.0)
    assert time.monotonic() - started < 1.0


def check_settings_are_checked_all_at_once():
    good, wrong = settings.settings({"frequency": 2, "other": object()}, 10.0)
    assert not wrong
    assert good == settings.Settings(2.0)
    own, _ = settings.settings({}, 10.0, 3.0)
    given, _ = settings.settings({"startup_grace": 0}, 10.0, 3.0)
    assert (own.startup_grace, given.startup_grace) == (3.0, 0.0)
    bad = {"frequency": float("nan"), "model": 3, "diagnostics": 1, "watchdog_period": -1}
    bad.update(on_master_loss=[], queue_size=0, startup_grace=-1)
    _, wrong = settings.settings(bad, 10.0)
    assert [text.split(":")[0] for text in wrong] == [f"parameter ~{name}" for name in bad]


def check_outputs_of_any_shape_pass_the_change_log():
    changes = health.Changes()
    said = []
    changes._log_change = lambda name, active: said.append((name, active))
    for output in (
        [{"id": "G", "active": False}],
        [{"id": "G", "active": False}],
        [{"id": "G", "active": True}],
        None,
        {"id": "G"},
        [1, {"id": "G", "active": True}],
    ):
        changes.note(output)
    assert said == [("G", True)]


if __name__ == "__main__":
    for name, check in sorted(globals().items()):
        if name.startswith("check_"):
            check()
            print("passed", name)
