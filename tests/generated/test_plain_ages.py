"""Plain packages of every kind lose what they know when messages, or calls, no longer come."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from tests.cli.command import ROOT, run
from tests.monitors.test_spellings import MODELS, ROBOT

pytestmark = pytest.mark.slow

TUTORIAL = (ROOT / "docs" / "tutorials" / "first-guarantee.md").read_text("utf-8")
CART = """
from types import SimpleNamespace as Message
from cart.EDDIInput import EDDIInput
from cart.EDDIMonitor import EDDIMonitor

def drives(step, fresh):
    told, monitor, found = EDDIInput(), EDDIMonitor(), []
    bumper, battery = Message(data=False), Message(percentage=0.8)
    for k in range(61):
        if fresh(k):
            bumper, battery = Message(data=False), Message(percentage=0.8)
        found += step(told, monitor, {"bumper": bumper, "battery": battery}, k * 10**8)
    return [row["active"] for row in found]

def whole(told, monitor, messages, t):
    told.processing(messages, t)
    return monitor.execute_step(told, t)

def stuck(told, monitor, messages, t):
    if t == 0:
        told.processing(messages, t)
    return monitor.monitor.execute_step(told, t)

assert drives(whole, lambda k: True) == [True] * 61
assert drives(whole, lambda k: False) == [True] * 6 + [False] * 55
assert drives(whole, lambda k: k % 10 == 0) == ([True] * 6 + [False] * 4) * 6 + [True]
assert drives(stuck, lambda k: True) == [True] * 6 + [False] * 55
"""
MONITORS = """
from types import SimpleNamespace as Message
from cart.EDDIInput import EDDIInput as Cart
from cart.EDDIMonitor import EDDIMonitor as CartMonitor
from fleet.EDDIInput import EDDIInput as Fleet
from fleet.EDDIMonitor import EDDIMonitor as FleetMonitor

cart, reader, cart_monitor, monitor = Cart(), Fleet(), CartMonitor().monitor, FleetMonitor()
found = []
for k in range(50):
    pressed, now = Message(data=30 <= k < 40), k * 10**8
    cart.processing({"bumper": pressed}, now)
    if k < 10 or k >= 25:  # for 1.5 s the cart's monitor is silent
        told = cart_monitor.message(cart_monitor.execute_step(cart, now))
    reader.processing({"cart": told}, now)
    found.append(monitor.execute_step(reader, now)[0]["active"])
    assert not monitor.monitor.faults(), monitor.monitor.faults()
assert found == [True] * 20 + [False] * 5 + [True] * 5 + [False] * 10 + [True] * 10, found
"""
MISSION = """
from types import SimpleNamespace as Message
from mission.EDDIInput import EDDIInput
from mission.EDDIMonitor import EDDIMonitor

def reliability():
    return Message(reason="", evidence=[Message(id="RtE_continue", active=True)])

told, monitor, found = EDDIInput(), EDDIMonitor(), []
for k in range(12):
    latest = reliability() if k in (0, 10) else latest
    told.processing({"reliability": latest}, k * 10**8)
    found.append(monitor.execute_step(told, k * 10**8)[0]["active"])  # ContinueMission
assert found == [True] * 6 + [False] * 4 + [True] * 2, found
"""
JOINED = """
from types import SimpleNamespace as Message
import wind.EDDIInput, wind.EDDIMonitor, ferry.EDDIInput, ferry.EDDIMonitor

mast, below = wind.EDDIInput.EDDIInput(), wind.EDDIMonitor.EDDIMonitor().monitor
told, above = ferry.EDDIInput.EDDIInput(), ferry.EDDIMonitor.EDDIMonitor().monitor
for k in range(44):
    t = k * 10**8
    if k < 40:
        speed = Message(data=5.0)
    mast.processing({"mast": speed}, t)
    messages = {"wind": below.message(below.execute_step(mast, t)), "hatch": Message(data=True)}
    if k < 10 or k > 40:
        messages["wind/why"] = below.why()
    told.processing(messages, t)
    above.execute_step(told, t)
    found = above.why()["Sail"]
    if k == 19:
        assert (found.verdict, found.sentence) == (2, "")
cause = "Calm <- calm <- wind <- /mast/wind: nothing for 0.4 s, limit 0.35 s"
assert found.sentence == "Sail <- " + cause, found
assert found.causes[0].monitors == ("ferry", "wind")
del messages["wind/why"]
told.processing(messages, t)
above.execute_step(told, t)
untold = "Sail <- Calm <- calm: unknown there, its monitor tells no reason"
assert above.why()["Sail"].sentence == untold, above.why()
"""
EVERY_KIND = """
import importlib, json, sys
from types import SimpleNamespace as Message

class Any:
    "A message with every field, whose values are good or bad for nothing; monitors' are known."
    omission, verdict = False, 2
    def __getattr__(self, name):
        return 0.5

found = {}
for package in sys.argv[1:]:
    told = importlib.import_module(package + ".EDDIInput").EDDIInput()
    monitor = importlib.import_module(package + ".EDDIMonitor").EDDIMonitor().monitor
    limited = [spec for spec in monitor.inputs if spec.max_age not in (None, "none")]
    names = {name for spec in monitor.inputs for name in spec.requires}
    told.processing({name: Any() for name in names}, 0)
    known = [spec for spec in limited if told.states[spec.id].state == "ok"]
    monitor.execute_step(told, 10**8)
    assert all(told.states[spec.id].state == "ok" for spec in known), package
    monitor.execute_step(told, 10**10)
    assert all(getattr(told, spec.attribute) is None for spec in known), package
    found[monitor.kind] = found.get(monitor.kind, 0) + len(known)
print(json.dumps(found))
"""


def program(text: str, folder: Path, *arguments: str) -> str:
    done = subprocess.run(
        [sys.executable, "-c", text, *arguments],
        cwd=folder,
        env={"PYTHONPATH": str(folder)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert not done.returncode, done.stderr
    return done.stdout


def test_the_cart_of_the_tutorial(tmp_path: Path) -> None:
    for name in ("cart.yml", "cart_config.yml"):
        block = re.search(rf"<!-- file: {name} -->\n```yaml\n(.*?)```", TUTORIAL, re.DOTALL)
        assert block is not None
        text = block[1].replace("battery.percentage,", "battery.percentage, unit: fraction,")
        (tmp_path / name).write_text(text, "utf-8")
    plain = ("generate", "--platform", "plain", "-o", ".", "-c", "cart_config.yml")
    assert run(*plain, cwd=tmp_path).status == 0
    program(CART, tmp_path)


def test_what_one_monitor_says_is_a_message_for_another(tmp_path: Path) -> None:
    for name, text in {**MODELS, "robot.yml": ROBOT}.items():
        (tmp_path / name).write_text(text, "utf-8")
    plain = ("generate", "--platform", "plain", "-o", ".", "-c", "robot.yml")
    assert run(*plain, cwd=tmp_path).status == 0
    program(MONITORS, tmp_path)


def test_evidence_of_another_monitor(tmp_path: Path) -> None:
    example = ROOT / "examples" / "drone"
    given = ("-m", "drone.xml", "--name", "Mission", "-c", "mission_config.yml")
    made = run("generate", "--platform", "plain", "-o", str(tmp_path), *given, cwd=example)
    assert made.status == 0, made.err
    program(MISSION, tmp_path)


def test_every_kind(tmp_path: Path) -> None:
    example = ROOT / "examples" / "warehouse-robot"
    plain = ("generate", "--platform", "plain", "-o", str(tmp_path))
    assert run(*plain, "-c", "robot.yml", cwd=example).status == 0
    packages = sorted(path.parent.name for path in tmp_path.glob("*/compiled.py"))
    found = json.loads(program(EVERY_KIND, tmp_path, *packages))
    assert len(found) == 5, found
    assert all(found.values()), found


def test_the_reasons_of_another_monitor(tmp_path: Path) -> None:
    oracle = ROOT / "tests" / "data" / "oracles" / "users" / "chains.yml"
    case = yaml.load(oracle.read_text("utf-8"), yaml.CSafeLoader)["cases"][0]
    for name, text in case["files"].items():
        (tmp_path / name).write_text(text, "utf-8")
    configs = [word for name in case["configurations"] for word in ("-c", name)]
    made = run("generate", "--platform", "plain", "-o", ".", *configs, cwd=tmp_path)
    assert made.status == 0, made.err
    program(JOINED, tmp_path)
