"""A managed node of ROS 2: at no listener does a guarantee outlive its activation."""

import signal
import time

import pytest

from tests.contract.stages import CONFIG, Ros2Stage
from tests.contract.test_scenarios import BOOL, HEALTHY
from tests.ros1.world import active, until
from tests.ros2.world import RELEASE, shared

pytestmark = [pytest.mark.slow, pytest.mark.ros]

NAME, GUARANTEES = "/rover", "/rover/guarantees"


class ManagedStage(Ros2Stage):
    """ROS 2 with a node whose states the tests decide."""

    def ask(self, what, **given):
        """Return the answer to a question about the life cycle."""
        mark = self.source.mark()
        self.source.do(what, node=NAME, **given)
        return self.source.wait(lambda one: one["event"] == "answered", 20.0, mark)["answer"]

    def change(self, label):
        assert self.ask("change", label=label) is True

    @property
    def state(self):
        return self.ask("state")

    def heard_late(self):
        """Return what is active for a listener that comes now, of the last that it is told."""
        late = self.new_probe()
        late.subscribe(GUARANTEES)
        late.wait(lambda event: event["event"] == "message", timeout=5.0)
        time.sleep(0.3)  # the publisher keeps two
        found = late.outputs(GUARANTEES)[-1]
        late.destroy()
        return active(found)

    def silent(self, seconds=1.5):
        """Return whether the node says nothing at all for a while."""
        mark = self.ear.mark()
        time.sleep(seconds)
        return self.ear.events(mark) == []


@pytest.fixture(scope="module")
def stage(tmp_path_factory):
    RELEASE.demand()
    folder = tmp_path_factory.mktemp("managed")
    config = folder / "config.yml"
    text = CONFIG.read_text("utf-8")
    config.write_text(text.replace("{id: Rover, ", "{id: Rover, lifecycle: true, "), "utf-8")
    made = ManagedStage(folder, config, shared(tmp_path_factory))
    made.begin()
    yield made
    made.destroy()


@pytest.fixture
def robot(stage):
    """Return a node of which nothing is known before, and that ends well."""
    node = stage.start()
    yield node
    assert node.end(signal.SIGTERM)[0] == 0, node.text
    assert "Traceback" not in node.text


def test_each_activation_knows_nothing_of_before(stage, robot):
    assert stage.state == "unconfigured"
    stage.feed(stage.source, HEALTHY, BOOL, True, connected=False)
    stage.change("configure")
    assert stage.state == "inactive"
    assert stage.silent()
    mark = stage.ear.mark()
    stage.change("activate")
    stage.until("Slow", after=mark)
    stage.told("", after=mark)  # on /diagnostics, the first time too
    for _ in range(2):
        stage.change("deactivate")
        stage.until(after=mark)
        assert stage.heard_late() == set()
        assert stage.silent()
        stage.source.do("stop", topic=HEALTHY)
        mark = stage.ear.mark()
        stage.change("activate")
        until(lambda mark=mark: len(stage.ear.outputs(GUARANTEES, mark)) > 5)
        assert stage.verdicts(mark) == "none"
        stage.feed(stage.source, HEALTHY, BOOL, True)
        stage.until("Slow")
        assert stage.verdicts(mark) == "none Slow"
    stage.source.do("stop", topic=HEALTHY)
    stage.change("deactivate")
    stage.change("cleanup")
    assert stage.state == "unconfigured"
    stage.change("configure")
    stage.change("activate")
    assert stage.heard_late() == set()
    stage.change("shutdown")
    assert stage.state == "finalized"


@pytest.mark.parametrize("last", ["shutdown", signal.SIGTERM, signal.SIGKILL])
def test_the_end_of_an_active_one(stage, last):
    mark, node = stage.ear.mark(), stage.start("/", "autostart:=true")
    stage.feed(stage.source, HEALTHY, BOOL, True)
    stage.until("Slow", after=mark)
    later = stage.ear.mark()
    if last == "shutdown":
        stage.change(last)
    else:
        node.send(last)
    if last != signal.SIGKILL:
        stage.until(after=later)
        assert stage.verdicts(mark) == "none Slow none"
        assert node.end(signal.SIGTERM)[0] == 0, node.text
    stage.source.do("stop", topic=HEALTHY)
    node.destroy()
    until(lambda: stage.silent(0.5))
    mark, node = stage.ear.mark(), stage.start("/", "autostart:=true")
    until(lambda: len(stage.ear.outputs(GUARANTEES, mark)) > 5)
    assert stage.verdicts(mark) == "none"
    assert node.end(signal.SIGINT)[0] == 0, node.text
