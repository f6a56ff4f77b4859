"""The test vectors of a ConSert, played to its node as messages."""

import os
import re
from pathlib import Path

import pytest

from tests.cli.command import EXAMPLE, edit, example, run
from tests.ros1.world import PYTHON, active, demand

pytestmark = [pytest.mark.ros, pytest.mark.slow]


def test_a_node_says_what_its_vectors_say(world, tmp_path):
    pytest.importorskip("rosbags", reason="the extra `bags` is not installed")
    demand(None if Path("/usr/bin/rosbag").exists() else "there is no rosbag: python3-rosbag")
    config = example(tmp_path) / "consert_a_config.yml"
    edit(config, "type: ConSert", "type: ConSert\n  model: two_conserts.xml")
    done = run("inject", config.name, "--vectors", "v.bag", cwd=config.parent)
    assert "v.bag: 9 vectors\n" in done.err
    package = EXAMPLE / "expected/src/eddi_monitor/conserta"
    core = world.master()
    env = world.env(core)
    env["PYTHONPATH"] = f"{package / 'src'}{os.pathsep}{env['PYTHONPATH']}"
    probe = world.probe(core)
    topic = "/conserta/guarantees"
    probe.subscribe(topic)
    node = world.process([PYTHON, str(package / "scripts/RosNode.py")], env)
    probe.active(topic, set(), 30.0, after=0)
    start = probe.mark()
    player = Path(__file__).parents[1] / "probes/play_bag.py"
    played = world.process([PYTHON, str(player), str(config.parent / "v.bag")], env)
    assert played.wait(60.0) == 0, played.text()
    counts = [str(len(active(event))) for event in probe.outputs(topic, start)]
    changes = "".join(of for k, of in enumerate(counts) if k == 0 or counts[k - 1] != of)
    # the second guarantee comes in the last vector, perhaps with the message after the first one's
    assert re.match("0?101?2", changes), changes
    node.end()
