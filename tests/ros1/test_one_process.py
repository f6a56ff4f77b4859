"""All monitors of a workspace in one process: what others see is that of separate nodes."""

import os
import signal

import pytest

from eddi_scaffold import api
from tests.cli.command import EXAMPLE
from tests.ros1.world import PYTHON, until

pytestmark = [pytest.mark.ros, pytest.mark.slow]

A, B, C = "/conserta/guarantees", "/consertb/guarantees", "/consertc/guarantees"
BOOL = "std_msgs/Bool"


class Workspace:
    """Three generated monitors, and the program that runs them all."""

    def __init__(self, folder):
        (folder / "src").mkdir()
        model = EXAMPLE / "two_conserts.xml"
        text = model.read_text("utf-8")
        third = folder / "third.xml"
        third.write_text(text.replace("ConSertB", "ConSertC").replace("ServiceB", "ServiceC"))
        config = (EXAMPLE / "consert_b_config.yml").read_text("utf-8")
        (folder / "c.yml").write_text(
            config.replace("ConSertB", "ConSertC").replace("consertb", "consertc")
        )
        configs = [EXAMPLE / f"consert_{letter}_config.yml" for letter in "ab"]
        api.generate(folder, model, configs, single_process=True)
        api.generate(folder, third, [folder / "c.yml"])
        self.packages = folder / "src" / "eddi_monitor"
        self.names = ("conserta", "consertb", "consertc")

    def file(self, name):
        return self.packages / "consertc" / "src" / "consertc" / name

    def run(self, world, master):
        env = world.env(master)
        paths = [str(self.packages / name / "src") for name in self.names]
        env["PYTHONPATH"] = os.pathsep.join([*paths, env["PYTHONPATH"]])
        program = self.packages / "eddi_monitor_launcher" / "scripts" / "EDDIMonitors.py"
        return world.process([PYTHON, str(program)], env)


@pytest.fixture(scope="module")
def generated(messages, tmp_path_factory):
    return Workspace(tmp_path_factory.mktemp("workspace"))


@pytest.fixture
def workspace(generated):
    """Return the workspace; what a test writes into the third monitor is taken back."""
    files = {path: path.read_bytes() for path in generated.file("").glob("*.py")}
    yield generated
    for path, data in files.items():
        path.write_bytes(data)


def test_they_look_like_separate_nodes_and_one_that_hangs_stops_no_other(
    workspace, world, master, probe
):
    code = workspace.file("EDDIInput.py")
    text = code.read_text("utf-8")
    old = "        self.RtE_A_E0 = RtE_E0.data\n"
    assert text.count(old) == 1
    code.write_text(text.replace(old, "        import time; time.sleep(1000)\n"), "utf-8")
    master.call("setParam", "/consertb/frequency", 50.0)
    process = workspace.run(world, master)
    for topic in (A, B, C):
        probe.subscribe(topic)
    for name in ("/conserta", "/consertb"):
        probe.diagnostics(name, lambda *_: True, timeout=30.0)
    state = dict(master.call("getSystemState")[0])
    assert {A, f"{A}/status", B, f"{B}/status", C, f"{C}/status"} <= set(state)
    assert state[A] == ["/eddi_monitor_launcher"]
    known = [
        probe.diagnostics(name, lambda *_: True)[2]["steps"]
        for name in ("/conserta", "/consertb")
        for _ in (1, 2)
    ]
    slow, fast = int(known[1]) - int(known[0]), int(known[3]) - int(known[2])
    assert fast > 2 * slow
    until(lambda: "/consertb: monitor of ConSertB" in process.text, what=process.text)
    probe.publish("/rte/e0b", BOOL, {"data": True}, connected=True)
    probe.active(B, {"System_A_G0_c2"}, timeout=30.0)
    probe.diagnostics("/consertc", lambda level, *_: level == 2, timeout=30.0)
    assert all(not one["data"]["guarantees"][0]["active"] for one in probe.outputs(C))
    status, seconds = process.end(signal.SIGINT)
    assert (status, seconds < 5.0) == (0, True)
    assert "Traceback" not in process.text


def test_one_that_cannot_start_is_reported(workspace, world, master, probe):
    compiled = workspace.file("compiled.py")
    compiled.write_text(compiled.read_text("utf-8") + "# changed\n", "utf-8")
    process = workspace.run(world, master)
    _, message, _ = probe.diagnostics("/consertc", lambda *_: True, timeout=30.0)
    assert message.startswith("not started: ")
    assert "was changed after it was generated" in process.text
    probe.subscribe(B)
    probe.active(B, set(), timeout=30.0)
    process.end(signal.SIGINT)
