"""``watch`` on a ROS 2 graph: real nodes over DDS, on loopback."""

import json
import re
import signal
import subprocess
import sys
import threading
import time

import pytest

pytest.importorskip("cyclonedds", reason="no DDS here")

from cyclonedds.domain import DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.topic import Topic
from eddi_runtime.transports.dds.graph import discovery_types, told, writing
from eddi_runtime.transports.dds.messages import message_classes

from eddi_scaffold.common.problems import EddiError
from eddi_scaffold.watch.dds_source import DdsGraphs
from eddi_scaffold.watch.fleet import FleetState
from tests.cli.command import ROOT, run
from tests.contract.stages import DdsStage, environment, free_domain
from tests.diagnosed import assert_reported
from tests.ros1.world import until


@pytest.fixture(scope="module")
def stage(tmp_path_factory):
    stage = DdsStage(tmp_path_factory.mktemp("dds"))
    yield stage
    stage.destroy()


class Watching:
    """The command, and the lines that it has printed."""

    def __init__(self, domain, *words):
        command = [sys.executable, "-m", "eddi_scaffold", "watch", "--json", "--domain"]
        self.popen = subprocess.Popen(
            [*command, str(domain), *words],
            env=environment(domain, ROOT),
            stdout=subprocess.PIPE,
            text=True,
        )
        self.rows, self._more = [], threading.Condition()
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self):
        for line in self.popen.stdout:
            with self._more:
                self.rows.append(json.loads(line))
                self._more.notify_all()

    def wait(self, after=0, timeout=20.0, **wanted):
        """Return the number of the first row after some that has these values."""
        with self._more:
            fits = lambda: [  # noqa: E731
                k for k, row in enumerate(self.rows) if k >= after and wanted.items() <= row.items()
            ]
            assert self._more.wait_for(fits, timeout), self.rows
            return fits()[0]

    def end(self):
        self.popen.send_signal(signal.SIGINT)
        status = self.popen.wait(10)
        self.popen.stdout.close()
        return status


def test_a_node_is_found_lost_and_found_again(stage):
    watching = Watching(stage.domain)
    node = stage.start("/robot1")
    first = watching.wait(robot="/robot1", monitor="rover")
    row = watching.rows[first]
    assert row["state"] in ("unknown", "not active")
    assert row["reasons"]
    node.send(signal.SIGKILL)
    killed = time.monotonic()
    gone = watching.wait(first, reasons=["no message for more than 3 s"])
    assert time.monotonic() - killed < 6.0
    again = stage.start("/robot1")
    back = watching.wait(gone, robot="/robot1", reasons=row["reasons"])
    assert back > gone
    again.end()
    words = ["-r", "__ns:=/robot2", "-r", "rover/guarantees/status:=/x"]  # no name of a robot
    command = [sys.executable, "-m", "rover", "--ros-args", *words]
    elsewhere = stage.process(command, stage.env())
    watching.wait(robot="/robot2", monitor="rover")
    elsewhere.end()
    assert watching.end() == 130


def test_a_claim_is_explained_once(stage, tmp_path, monkeypatch):
    monkeypatch.setenv("CYCLONEDDS_URI", environment(stage.domain)["CYCLONEDDS_URI"])
    node = stage.start("/robot3")
    ask = lambda claim: run("explain", claim, "--domain", stage.domain, cwd=tmp_path)  # noqa: E731
    done = ask("Slow")
    first, second = done.out.splitlines()
    chain = "Healthy <- /robot3/in/healthy: no message yet, "
    assert (done.status, first.startswith(f"robot3/rover: Slow <- {chain}")) == (1, True), done
    assert re.match(rf"  since \d\d:\d\d:\d\d\.\d\d\d  {chain}", second)
    stage.feed(stage.new_probe(), "/robot3/in/healthy", "std_msgs/Bool", True)
    done = until(lambda: of if not (of := ask("robot3/rover.Slow")).status else None)
    assert done.out == "robot3/rover: Slow holds\n"
    done = ask("Slowly")
    assert (done.status, "nobody tells of a claim 'Slowly'" in done.err) == (2, True)
    assert "did you mean 'Slow'?" in done.err
    node.end()


def test_without_the_wheel_it_says_what_to_install(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "eddi_scaffold.watch.dds_source", None)
    result = run("watch", "--text", "--domain", "3", cwd=tmp_path)
    assert result.status == 2
    assert_reported("I010", result.err)


def named(participant, writer, node, size):
    """Tell the graph of which node a writer is, as a release with identities of that size."""
    types = discovery_types(size)
    gid = types.rmw_dds_common_Gid()
    gid.data = writer.get_guid().bytes.ljust(size, b"\0")
    namespace, _, name = node.rpartition("/")
    entities = types.rmw_dds_common_NodeEntitiesInfo(
        node_namespace=namespace, node_name=name, writer_gid_seq=[gid]
    )
    info = types.rmw_dds_common_ParticipantEntitiesInfo
    told_to = DataWriter(
        participant, Topic(participant, "ros_discovery_info", info), writing({}, 1)
    )
    told_to.write(info(gid=gid, node_entities_info_seq=[entities]))
    return told_to


def published(domain, *, other=False, size=None):
    """Return what publishes the status of a ConSert in a domain, and what must live on."""
    parts = {
        "builtin_interfaces/Time": "int32 sec, uint32 nanosec",
        "std_msgs/Header": "builtin_interfaces/Time stamp, string frame_id",
        "eddi_messages/GuaranteeStatus": "string id, uint8 verdict, string[] missing",
        "eddi_messages/ConSertStatus": "std_msgs/Header header, string model_id,"
        " string model_digest, eddi_messages/GuaranteeStatus[] guarantees, string[] accepted",
    }
    if other:  # the right name, another definition
        parts["eddi_messages/ConSertStatus"] = "uint8 one"
    of = message_classes(parts)
    participant = DomainParticipant(domain)
    cls = of.eddi_messages_ConSertStatus
    name = "rt/odd/guarantees/status" if other else "rt/cart/guarantees/status"
    writer = DataWriter(participant, Topic(participant, name, cls), told(cls, writing({}, 1)))
    if other:
        return lambda: writer.write(cls(one=7)), participant
    keep = named(participant, writer, "/cell/cart/main", size) if size else None
    row = of.eddi_messages_GuaranteeStatus(id="G", verdict=2, missing=[])
    message = cls(model_id=f"M{domain}", guarantees=[row])

    def write():
        message.header.stamp.nanosec += 1
        writer.write(message)

    return write, (participant, keep)


def test_several_domains_are_several_robots_and_liars_are_named(monkeypatch):
    (one, first), (two, second) = free_domain(), free_domain()
    monkeypatch.setenv("CYCLONEDDS_URI", environment(first)["CYCLONEDDS_URI"])
    makers = [published(first), published(second, size=16), published(second, other=True)]
    graphs = DdsGraphs([first, second])
    state = FleetState()
    came = []
    end = time.monotonic() + 20.0
    while time.monotonic() < end and (len(came) < 40 or len(state.snapshot(0.0).robots) < 2):
        for write, _ in makers:
            write()
        for message in graphs.receive(0.05)[1]:
            came.append(message)
            state.take(message)
    robots = state.snapshot(time.monotonic()).robots
    names = {robot.name: [one.name for one in robot.monitors] for robot in robots}
    cart = f"/domain{second}/cell/cart"
    assert names == {f"/domain{first}": [f"M{first}"], cart: [f"M{second}"]}
    assert [robot.monitors[0].verdicts[0].state for robot in robots] == ["active", "active"]
    (note,) = graphs.notes()
    assert note.startswith(f"/domain{second}/odd/guarantees/status: a publisher has another defi")
    own = {id(message.content) for message in came if f"/domain{first}/" in message.topic}
    assert len(own) == 1  # what is equal behind its stamp is decoded once
    graphs.close()
    one.close()
    two.close()


def test_a_domain_that_cannot_be_joined_is_told(monkeypatch):
    monkeypatch.setenv("CYCLONEDDS_URI", "file:///nowhere.xml")
    lock, domain = free_domain()
    with pytest.raises(EddiError, match="no participant in domain"):
        DdsGraphs([domain])
    lock.close()
