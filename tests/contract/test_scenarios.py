"""What a monitor must do on every transport: the verdicts of each scenario are equal on all.

A scenario begins and ends with nothing active; the node is the same in all that do not need their
own.
"""

import re
import signal
import time
from itertools import pairwise

import pytest

from tests.ros1 import world
from tests.ros1.world import until

pytestmark = pytest.mark.slow

BOOL, NUMBER, TEXT = "std_msgs/Bool", "std_msgs/Float64", "std_msgs/String"
HEALTHY, CLEAR, MODE = "/in/healthy", "/in/clear", "/in/mode"


def calm_down(stage, *topics):
    """Stop sources and wait until their values are too old."""
    for topic in topics:
        stage.source.do("stop", topic=topic)
    stage.until()


def test_nothing_is_known_at_the_start(stage):
    stage.until()
    _, values = stage.told("s after the start (nobody publishes it")
    assert [values[one] for one in ("Healthy", "Clear", "Mode")] == ["missing"] * 3
    assert stage.verdicts(0) == "none"


def test_every_flip_is_seen_in_its_order(stage):
    mark = stage.ear.mark()
    stage.source.publish(HEALTHY, BOOL, {"data": False}, connected=True)
    time.sleep(0.3)  # the other side may not know yet that it is connected
    for _ in range(10):
        for value, active in ((True, ["Slow"]), (False, [])):
            before = stage.ear.mark()
            stage.source.publish(HEALTHY, BOOL, {"data": value})
            stage.until(
                *active, after=before, timeout=0.75
            )  # younger than max_age: it was this one
    assert stage.verdicts(mark) == "none" + " Slow none" * 10


def test_a_number_that_is_no_good_evidence(stage):
    mark = stage.ear.mark()
    stage.feed(stage.source, HEALTHY, BOOL, True)
    stage.until("Slow")
    for bad in (float("nan"), -1.0, 1e300, float("inf"), 2.4999):
        stage.feed(stage.source, CLEAR, NUMBER, 2.5)
        stage.until("Fast", "Slow")
        stage.source.do("stop", topic=CLEAR)
        stage.feed(stage.source, CLEAR, NUMBER, bad)
        before = stage.ear.mark()
        stage.until("Slow", after=before, timeout=0.75)  # younger than max_age: it is the value
        stage.source.do("stop", topic=CLEAR)
    calm_down(stage, HEALTHY)
    assert stage.verdicts(mark) == "none Slow" + " Fast+Slow Slow" * 5 + " none"


def test_silence_and_a_return(stage):
    mark = stage.ear.mark()
    stage.feed(stage.source, HEALTHY, BOOL, True)
    stage.until("Slow")
    stage.source.do("stop", topic=HEALTHY)
    stage.until()
    stage.told("/in/healthy: nothing for ")
    late = "lost Slow <- Healthy <- /in/healthy: nothing for"
    until(lambda: late in stage.robot.text and "(its publisher is there)" in stage.robot.text)
    stage.feed(stage.source, HEALTHY, BOOL, True)
    stage.until("Slow")
    until(lambda: "again Slow after" in stage.robot.text)
    calm_down(stage, HEALTHY)
    assert stage.verdicts(mark) == "none Slow none Slow none"


def test_a_publisher_that_is_killed_and_its_successor(stage):
    mark = stage.ear.mark()
    for _ in range(2):
        other = stage.new_probe()
        stage.feed(other, HEALTHY, BOOL, True)
        stage.until("Slow")
        other.popen.kill()
        stage.until()
    assert stage.verdicts(mark) == "none Slow none Slow none"


def test_a_publisher_that_ends_is_said_to_be_gone(stage):
    other = stage.new_probe()
    stage.feed(other, MODE, TEXT, "park")  # nobody else has published it before
    stage.until("Calm")
    other.popen.send_signal(signal.SIGINT)
    stage.until()
    stage.told("/in/mode: publisher gone ")
    line = "(lost|still) Calm <- Mode <- /in/mode: publisher gone"
    until(lambda: re.search(line, stage.robot.text), what=line)


def test_of_two_publishers_the_living_one_counts(stage):
    mark = stage.ear.mark()
    other = stage.new_probe()
    stage.feed(other, HEALTHY, BOOL, True)
    stage.feed(stage.source, HEALTHY, BOOL, True)
    stage.until("Slow")
    other.popen.kill()
    later = stage.ear.mark()
    until(lambda: len(stage.ear.outputs("/rover/guarantees", later)) > 20)
    assert stage.verdicts(mark) == "none Slow"
    calm_down(stage, HEALTHY)


def test_who_comes_late_gets_the_last_output(stage):
    stage.feed(stage.source, HEALTHY, BOOL, True)
    stage.until("Slow")
    late = stage.new_probe()
    late.subscribe("/rover/guarantees")
    found = late.wait(lambda event: event["event"] == "message", timeout=3.0)
    assert {one["id"] for one in found["data"]["guarantees"] if one["active"]} == {"Slow"}
    calm_down(stage, HEALTHY)


def test_hand_written_code_that_raises(stage):
    mark = stage.ear.mark()
    stage.feed(stage.source, HEALTHY, BOOL, True)
    stage.until("Slow")
    stage.feed(stage.source, MODE, TEXT, "park")
    stage.until("Calm", "Slow")
    stage.source.do("stop", topic=MODE)
    stage.feed(stage.source, MODE, TEXT, "raise")
    _, values = stage.told("Mode invalid: ValueError: on purpose")
    assert values["Healthy"] == "ok"
    stage.source.do("stop", topic=MODE)
    stage.feed(stage.source, MODE, TEXT, "park")
    stage.until("Calm", "Slow")
    calm_down(stage, HEALTHY, MODE)
    assert stage.robot.text.count("on purpose") >= 1
    said = "none Slow Calm\\+Slow Slow Calm\\+Slow( Slow| Calm)? none"
    assert re.fullmatch(said, stage.verdicts(mark)), stage.verdicts(mark)


def test_a_burst_and_a_subscriber_that_takes_nothing(stage):
    frozen = stage.new_probe()
    frozen.subscribe("/rover/guarantees")
    frozen.wait(lambda event: event["event"] == "message")
    frozen.popen.send_signal(signal.SIGSTOP)
    mark = stage.ear.mark()
    stage.feed(stage.source, HEALTHY, BOOL, True, hz=2000)
    stage.until("Slow")
    later = stage.ear.mark()
    until(lambda: len(stage.ear.outputs("/rover/guarantees", later)) > 20)
    times = [one["t"] for one in stage.ear.outputs("/rover/guarantees", later)]
    calm_down(stage, HEALTHY)
    assert stage.verdicts(mark) == "none Slow none"
    assert max(b - a for a, b in pairwise(times)) < 0.5, "steps were missed"


def test_another_type_and_an_old_value_on_the_topics(stage):
    """A node of its own, in a namespace: nothing that is not fresh and of its type is believed."""
    stage.source.publish("/robot1/in/mode", TEXT, {"data": "park"}, latch=True)
    liar = stage.new_probe()
    stage.feed(liar, "/robot1/in/healthy", TEXT, "True", connected=False)
    mark = stage.ear.mark()
    node = stage.start("/robot1", "frequency:=10")
    name = "/robot1/rover"
    wrong = "/robot1/in/healthy: std_msgs/String comes, std_msgs/Bool is needed"
    stage.told(wrong, name)
    liar.destroy()
    assert stage.verdicts(mark, name) == "none"
    assert node.end(signal.SIGINT) < (0, 2.5)


def test_the_time_of_a_simulation_and_a_clock_that_jumps(stage):
    """Windows follow /clock; ages of messages do not, so a clock that stands hides nothing."""
    name = "/robot1/rover"
    mark, node = stage.ear.mark(), stage.start_simulated("/robot1")
    stage.feed(stage.source, "/robot1/in/steady", BOOL, True, hz=20)
    until(lambda: "nothing has come on /clock" in node.text, what=f"a warning: {node.text}")

    def run(seconds):
        """Let time pass, half as fast as it does, until all of the window is known."""
        start, before = seconds, stage.ear.mark()
        while not any(
            "Patient" in world.active(one)
            for one in stage.ear.outputs(f"{name}/guarantees", before)
        ):
            assert seconds < start + 20.0, node.text
            stage.clock(seconds)
            time.sleep(0.1)  # more than a step
            seconds += 0.05
        return seconds

    stage.clock(100.0)
    time.sleep(2.0)
    stage.until(name=name)  # no time has passed
    end = run(100.0)
    assert end > 100.8
    stage.clock(50.0)  # the recording begins again: nothing is known of its past
    stage.until(name=name)
    until(lambda: "/clock jumped back by" in node.text, what=f"a warning: {node.text}")
    run(50.0)
    stage.source.do("stop", topic="/robot1/in/steady")
    stage.until(name=name)  # the clock stands still, the sensor is silent
    assert stage.verdicts(mark, name) == "none Patient none Patient none"
    assert node.end(signal.SIGTERM)[0] == 0


def test_a_restart_knows_nothing_of_before(stage):
    name = "/robot1/rover"
    mark, node = stage.ear.mark(), stage.start("/robot1")
    stage.feed(stage.source, "/robot1/in/healthy", BOOL, True)
    stage.until("Slow", name=name, after=mark)
    stage.source.do("stop", topic="/robot1/in/healthy")
    node.send(signal.SIGKILL)
    assert node.wait() == -signal.SIGKILL
    node = stage.start("/robot1")
    stage.until(name=name)
    stage.feed(stage.source, "/robot1/in/healthy", BOOL, True)
    stage.until("Slow", name=name)
    assert stage.verdicts(mark, name) == "none Slow none Slow"
    stage.source.do("stop", topic="/robot1/in/healthy")
    assert node.end(signal.SIGTERM)[0] == 0


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_the_end(stage, number):
    """With status 0 and soon; the last word is that nothing is known (rospy sends no last word)."""
    mark, name = stage.ear.mark(), "/robot1/rover"
    node = stage.start("/robot1")
    stage.feed(stage.source, "/robot1/in/healthy", BOOL, True, connected=False)
    stage.until("Slow", name=name, after=mark)
    status, seconds = node.end(number)
    assert (status, seconds < 2.5) == (0, True), node.text
    stage.source.do("stop", topic="/robot1/in/healthy")
    assert "Traceback" not in node.text
    if stage.core is None:
        until(lambda: stage.verdicts(mark, name) == "none Slow none")


@pytest.mark.parametrize(("slow", "sign"), [("5", "begun"), ("", "monitor of")])
def test_the_end_of_a_node_that_has_only_begun(stage, slow, sign):
    """While hand-written code is made, on ROS 2 a node of the graph already, and a moment later."""
    env = {**stage.env(stage.core), "SLOW_START": slow}
    node = stage.process(stage.command("/robot1"), env)
    until(lambda: sign in node.text, what="its first words")
    status, seconds = node.end(signal.SIGTERM)
    assert (status, seconds < 2.5) == (0, True), node.text
    assert "Traceback" not in node.text


def test_it_never_crashed(stage):
    assert stage.robot.popen.poll() is None
    assert stage.robot.end(signal.SIGTERM)[0] == 0, stage.robot.text
    assert "Traceback" not in stage.robot.text.replace("Traceback (most recent call last):", "", 1)
