"""Every kind of monitor on a real ROS 1, without a hand edit, in one workspace and one launch.

Two topics make an event and an event evidence; every frame counts once; a rotor fails and the
probability of failure jumps; speed and distance become a risk; expressions judge fields; the models
of a real robot become a monitor. Each guarantee goes away when its sources die.
"""

import json
import math
import random
import time
from pathlib import Path
from types import SimpleNamespace

import pytest

from eddi_scaffold.packages.running import load
from tests.checkouts import HERE
from tests.cli.command import run as eddi
from tests.connect.test_robots import consert, decided
from tests.data_files import data_file
from tests.e2e.robot import Run, end
from tests.e2e.workspace import Workspace
from tests.ros1.world import PYTHON, until

pytestmark = [pytest.mark.ros, pytest.mark.slow]
EXAMPLES = HERE / "examples"
PATIENCE_S = 30.0
EVENTS, DRIVE = "/motor/events", "/drive/guarantees"
SCOPE, LANDING = "/camera_scope/safeml", "/landing/guarantees"
RELIABILITY, MISSION = "/drone/reliability", "/drone/guarantees"
RISK, LOW, CROSSING = "/pedestrian/risk", "/pedestrian/risk/low", "/crossing/guarantees"
ROVER, BASE = "/rover/guarantees", "/base/guarantees"
TOPICS = (
    EVENTS, DRIVE, SCOPE, f"{SCOPE}/status", LANDING, RELIABILITY, MISSION, RISK, f"{RISK}/status",
    f"{RISK}/evidence", LOW, CROSSING, f"{CROSSING}/status", ROVER, BASE, "/diagnostics",
)  # fmt: skip
STREAM = Path(__file__).with_name("safeml_stream.py")
UNKNOWN, TRUE, FALSE = 1, 2, 0
FLYING = {"ContinueMission": True, "Land": True}
LANDED = {"ContinueMission": False, "Land": True}
NETWORK = "/pedestrian_prediction_example"
PERIOD_S, MAX_AGE_S = 0.1, 0.5
SLACK_S = 0.5  # transport and a machine that others use as well
EVIDENCE = f'{{id: RiskIsLow, node: Critical, state: "Yes", at_most: 0.35, topic: {LOW}}}'
CROSSING_MODEL = """\
guarantees: [{id: Cross, dimensions: [{Binary: {type: SafeCrossing}}]}]
demands: []
evidence: [{id: RiskIsLow, dimension: {Binary: {type: LowRisk}}}]
gates: []
tree_propagations: [{from: RiskIsLow, to: Cross}]
required_services: []
provided_services: []
"""
CROSSING_CONFIG = """\
Model: {id: Crossing, type: ConSert, parameters: [{model: crossing.yml}]}
SimulatorOutputs:
  - {id: risk, type: eddi_messages.BayesianNetworkEvidence, topic: pedestrian/risk/evidence}
EDDIInputs:
  - {id: RiskIsLow, type: bool, requires: [risk], field: "evidence[RiskIsLow].active"}
EDDIOutputs:
  - {id: crossing, topic: crossing/guarantees}
"""


INPUTS = {"RightLaserStandby": None, "LeftLaserStandby": None, "DistanceAhead": "m"}
SCAN = "{range_max: 30.0, angle_increment: 0.1, angle_max: 0.2, ranges: [1.0, 1.5, 9.0]}"


class Kinds(Run):
    TOPICS = TOPICS

    def send(self, topic, type_, data, rate=20):
        """Leave ``rostopic pub`` repeating a message, faster than it grows too old."""
        return self._start("rostopic", "pub", "-r", str(rate), topic, type_, data)

    def number(self, topic, value, type_="std_msgs/Float64"):
        return self.send(topic, type_, f"data: {value}")

    def truth(self, topic, value):
        return self.send(topic, "std_msgs/Bool", f"data: {str(value).lower()}")

    def last(self, topic, guarantee):
        """Return what the last message says of a guarantee, nothing before the first."""
        return [state[guarantee] for state in self.states(topic)[-1:]]


@pytest.fixture(scope="module")
def workspace(folder, home):
    """The examples as they are, a ConSert behind the network, and a monitor of a real robot."""
    config = folder / "eddi_config.yml"
    text = (EXAMPLES / "pedestrian" / "eddi_config.yml").read_text()
    config.write_text(text.replace("Simulator", f"  evidence: [{EVIDENCE}]\nSimulator", 1))
    (folder / "crossing.yml").write_text(CROSSING_MODEL)
    crossing = folder / "crossing_config.yml"
    crossing.write_text(CROSSING_CONFIG)
    monitors = {
        "motor-watch/drive.yml": ("motor_config.yml", "drive_config.yml"),
        "safeml/landing.yml": ("perception_config.yml", "landing_config.yml"),
        "drone/drone.xml": ("reliability_config.yml", "mission_config.yml"),
        "rover-events/Rover.yml": ("eddi_config.yml",),
        "pedestrian/pedestrian.xml": (config, crossing),
    }
    made = Workspace(folder / "kinds", home)
    for model, configs in monitors.items():
        path = EXAMPLES / model
        made.generate(path, *(path.parent / name for name in configs))
    made.generate(*connected(folder))
    output = made.catkin_make()
    assert "CMake Warning" not in output, output
    return made


def connected(folder):
    """Return a model and what `connect` and a person make of it for a real robot."""
    models = data_file("mros/expected/cob4_ros_tool_test.models")
    config, model = folder / "base_config.yml", folder / "Base.yml"
    model.write_text(consert(INPUTS))
    robot = ("--system", models / "cob4_ros_tool_test.rossystem", "--models", models)
    assert eddi("connect", model, *robot, "-o", config, cwd=folder).status == 0
    lines = {"DistanceAhead": "MIN(base_laser_front_scan.ranges[*])"}
    text, count = decided(config.read_text(), lines)
    assert (text.count("topic: /"), count) == (41, 4)
    config.write_text(text)
    return model, config


@pytest.fixture(scope="module")
def run(workspace, roscore, folder):
    with Kinds(roscore, workspace.devel_env(), folder / "run") as running:
        yield running
        said = running.launch_text()
    assert "died" not in said, said
    assert "Traceback" not in said, said


def test_two_topics_make_an_event_and_that_a_guarantee(run):
    def verdict():
        return [message["verdict"] for message in run.messages(EVENTS)[-1:]]

    def feed(topic, value):
        return run.number(topic, value, "std_msgs/Float32")

    until(lambda: verdict() == [UNKNOWN], 30.0, "the first word")
    assert run.last(DRIVE, "FullSpeed") in ([], [False])
    current = feed("/motor/current", 6)
    cool = feed("/motor/temperature", 55)
    until(lambda: verdict() == [TRUE], 30.0, "the event")
    until(lambda: run.last(DRIVE, "FullSpeed") == [True], 10.0, "the guarantee")
    cool.end()
    hot = feed("/motor/temperature", 95)
    until(lambda: verdict() == [FALSE], 30.0, "the end of the event")
    until(lambda: run.last(DRIVE, "FullSpeed") == [False], 10.0, "the end of the guarantee")
    hot.end()
    cool = feed("/motor/temperature", 55)
    until(lambda: run.last(DRIVE, "FullSpeed") == [True], 30.0, "the guarantee again")
    current.end()  # silence is no evidence
    until(lambda: verdict() == [UNKNOWN], 10.0, "the silence")
    until(lambda: run.last(DRIVE, "FullSpeed") == [False], 10.0, "the guarantee without the event")
    cool.end()
    messages = run.messages(EVENTS)
    assert {message["id"] for message in messages} == {"MotorFit"}
    assert {tuple(sorted(set(message) - {"header"})) for message in messages} == {
        ("accepted", "active", "cleared", "id", "raised", "verdict")
    }
    assert sum(message["raised"] for message in messages) == 2
    assert all(message["active"] == (message["verdict"] == TRUE) for message in messages)


def recorded():
    """Return the frames of the example's recording: usual ones, then those in fog."""
    lines = (EXAMPLES / "safeml" / "recording.csv").read_text().splitlines()
    cells = [line.partition(",")[2] for line in lines[1:]]
    frames = [[float(part) for part in cell.split()] for cell in cells if cell and '"' not in cell]
    whole = [frame for frame in frames if len(frame) == 6]
    return whole[:110], whole[110:]


def spoilt(frames, chance):
    """Put five empty frames and five with NaN among some."""
    frames = list(frames)
    for bad in [[]] * 5 + [[math.nan] * 6] * 5:
        frames.insert(chance.randrange(60, len(frames)), bad)
    return frames


def offline(package, frames):
    """Return (accepted, rejected) -> the result after each frame, without ROS."""
    monitor = load(package).new()[0].monitor
    found = {}
    for frame in frames:
        result = monitor.execute_step(SimpleNamespace(frame=frame), 0)
        found[result.accepted, result.rejected] = result
    return found


def test_from_the_camera_to_the_guarantee(workspace, run, tmp_path):
    usual, fog = recorded()
    frames = [*spoilt(usual, random.Random(4)), *fog]
    (tmp_path / "frames.json").write_text(json.dumps(frames))
    expected = offline(workspace.packages / "camera_scope", frames)
    until(lambda: run.messages(SCOPE), 30.0, "the first word")
    assert run.messages(SCOPE)[0]["omission"] is True
    run._start(PYTHON, str(STREAM), str(tmp_path / "frames.json"))
    total = (len(frames) - 10, 10)
    until(lambda: total in counted(run), 60.0, "all frames counted")
    until(lambda: run.last(LANDING, "PreciseLanding") == [False], 10.0, "the guarantee's end")
    statuses, outputs = run.messages(f"{SCOPE}/status"), run.messages(SCOPE)
    check_statuses(statuses, expected)
    assert statuses[-1]["odd_violation"]
    usual_ones = [one for one in statuses if one["accepted"] <= len(usual)]
    assert not any(one["odd_violation"] for one in usual_ones)
    # an empty frame and one with NaN are omissions, also where the window is full
    assert {"", "empty", "not_finite"} <= {
        one["reason"] for one in usual_ones if one["filled"] == 50
    }
    assert outputs[-1]["significance_level"] == pytest.approx(0.01, abs=1e-8)
    assert any(state["PreciseLanding"] for state in run.states(LANDING))


def counted(run):
    return {counts(status) for status in run.messages(f"{SCOPE}/status")[-10:]}


def counts(status):
    return status["accepted"], status["rejected"]


def check_statuses(statuses, expected):
    """Each verdict is the one that the same frames give without ROS."""
    compared = 0
    for status in statuses:
        if not status["omission"]:
            wanted = expected[counts(status)]
            assert status["statistic"] == pytest.approx(wanted.statistic, rel=1e-9)
            assert status["threshold"] == wanted.threshold
            assert status["component"] == wanted.component
            compared += 1
    assert compared > 30


def test_from_the_rotor_to_the_guarantee(run):
    def last():
        return run.messages(RELIABILITY)[-1]

    rotors = run.truth("/drone/rotors_ok", True)
    link = run.truth("/drone/link_lost", False)
    run.wait_for(MISSION, FLYING, 40.0)
    flying = last()
    assert (flying["valid"], flying["accepted"]) == (True, [])
    assert flying["evidence"] == [{"id": "RtE_continue", "active": True}]
    assert flying["p_fail"] == pytest.approx(5.155e-6, rel=1e-2)
    assert flying["p_fail_low"] == flying["p_fail_high"] == flying["p_fail"]
    assert flying["horizon_seconds"] == 1800.0

    end(link)  # silence: what is not known is no evidence
    run.wait_for(MISSION, LANDED, 10.0)
    silent = last()
    assert (silent["valid"], silent["unknown_inputs"]) == (False, ["MissionLoss_Link"])
    assert silent["p_fail_high"] == 1.0
    run.truth("/drone/link_lost", False)
    run.wait_for(MISSION, FLYING, 10.0)

    end(rotors)
    run.truth("/drone/rotors_ok", False)
    until(lambda: last()["valid"] and last()["p_fail"] > 1e-3, 10.0, "the jump")
    run.wait_for(MISSION, LANDED, 10.0)
    fallen = last()
    assert fallen["p_fail"] > 1000 * flying["p_fail"]
    assert fallen["evidence"] == [{"id": "RtE_continue", "active": False}]


def test_speed_and_distance_become_a_risk(run):
    wait_for_risk(run, 0.3385)  # nothing is observed: the prior
    speed = run.number("/vehicle/speed", 4 / 3.6)
    wait_for_risk(run, 0.36)
    distance = run.number("/pedestrian/distance", 0.4)
    wait_for_risk(run, 0.7)
    distance.destroy()
    wait_for_risk(run, 0.36)  # the last distance is too old
    distance = run.number("/pedestrian/distance", 5.3)
    wait_for_risk(run, 0.2)
    message = run.messages(RISK)[-1]
    assert [node["title"] for node in message["output_nodes"]] == ["Critical"]
    outcomes = [outcome["outcome_name"] for outcome in message["output_nodes"][0]["outcomes"]]
    assert outcomes == ["Yes", "No"]
    wait_for_low(run, active=True)
    distance.destroy()
    wait_for_low(run, active=False)  # 0.36 is what the prior says of the distance
    speed.destroy()
    wait_for_risk(run, 0.3385)  # below the limit, because both sensors died
    last = run.messages(f"{RISK}/evidence")[-1]
    assert last["unknown_inputs"] == ["vehicleSpeed", "pedestrianDistance"]
    (low,) = last["evidence"]
    assert (low["id"], low["active"], low["reason"]) == ("RiskIsLow", False, "unknown inputs")
    assert (low["low"], low["high"]) == (0.05, 0.95)
    assert run.messages(LOW)[-1] == {"data": False}
    sensors_die_under_the_guarantee(run)
    states = [message["status"] for message in run.messages(f"{RISK}/status")]
    assert states[0] == 2  # PRIOR
    assert {1, 0} <= set(states)  # PARTIAL, then OK


def wait_for_risk(run, value):
    """Wait for the probability of Critical=Yes."""

    def came():
        assert run.launch.popen.poll() is None, run.launch_text()
        last = run.messages(RISK)[-1:]
        outcomes = [message["output_nodes"][0]["outcomes"][0] for message in last]
        return bool(last) and abs(outcomes[0]["outcome_value"] - value) < 1e-6

    until(came, PATIENCE_S, f"a risk of {value}")


def wait_for_low(run, *, active):
    """Wait until the evidence and its own topic say the same."""

    def came():
        rows = [message["evidence"] for message in run.messages(f"{RISK}/evidence")[-1:]]
        own = [message["data"] for message in run.messages(LOW)[-1:]]
        return [row[0]["active"] for row in rows] == [active] == own

    until(came, PATIENCE_S, f"evidence {active}")


def sensors_die_under_the_guarantee(run):
    """Kill both sensors while a guarantee rests on them: it ends in time, and they are named."""
    sensors = [run.number("/vehicle/speed", 4 / 3.6), run.number("/pedestrian/distance", 5.3)]
    run.wait_for(CROSSING, {"Cross": True}, PATIENCE_S)
    for sensor in sensors:
        sensor.popen.kill()
    dead = time.time()
    run.wait_for(CROSSING, {"Cross": False}, PATIENCE_S)

    def named():
        said = run.diagnosis(NETWORK)
        return said.get("threshold.RiskIsLow", "").count(" is late, ") == 2 and said

    said = until(named, PATIENCE_S, "a diagnosis")
    why = said["threshold.RiskIsLow"]
    assert why.startswith("inactive: vehicleSpeed: /vehicle/speed is late, "), why
    assert "; pedestrianDistance: /pedestrian/distance is late, " in why
    assert (said["vehicleSpeed"], said["pedestrianDistance"]) == ("stale", "stale")
    # the last status that is TRUE is of a step before the limit, and a period of each monitor
    stamps = [
        status["header"]["stamp"]
        for status in run.messages(f"{CROSSING}/status")
        if status["guarantees"][0]["verdict"] == TRUE
    ]
    last = max(stamp["secs"] + stamp["nsecs"] / 1e9 for stamp in stamps)
    assert last - dead <= MAX_AGE_S + 2 * PERIOD_S + SLACK_S

    def blamed():
        text = run.diagnosis("/crossing").get("guarantee.Cross")
        return text == "inactive: RiskIsLow: unknown there"

    until(blamed, PATIENCE_S, "a diagnosis of the guarantee")


def test_battery_and_motor_become_evidence(workspace, run):
    assert workspace.eddi_input("rover").read_text().count("self.expression(") == 2
    run.wait_for(ROVER, {"MayDrive": False}, PATIENCE_S)
    battery = "{present: true, percentage: 0.8}"
    run.send("/battery", "sensor_msgs/BatteryState", battery)
    motor = run.number("/motor/temperature", 40.0, "std_msgs/Float32")
    run.wait_for(ROVER, {"MayDrive": True}, PATIENCE_S)
    motor.destroy()
    run.wait_for(ROVER, {"MayDrive": False}, PATIENCE_S)  # nobody knows how hot it is
    motor = run.number("/motor/temperature", 40.0, "std_msgs/Float32")
    run.wait_for(ROVER, {"MayDrive": True}, PATIENCE_S)
    # Not at the other's rate: the monitor takes the last message of a step, and of two that
    # keep in step it could be the same one for ever.
    hot = run.send("/motor/temperature", "std_msgs/Float32", "data: 90.0", rate=97)
    run.wait_for(ROVER, {"MayDrive": False}, PATIENCE_S)
    hot.destroy()
    run.wait_for(ROVER, {"MayDrive": True}, PATIENCE_S)  # two seconds without heat
    motor.destroy()


def test_a_real_system_becomes_a_monitor_that_runs(run):
    run.wait_for(BASE, {"Fine": False}, 30.0)
    for side in ("left", "right"):
        run.publish(f"/base_laser_{side}/scan_standby")
    scan = run.send("/base_laser_front/scan", "sensor_msgs/LaserScan", SCAN)
    run.wait_for(BASE, {"Fine": True}, 30.0)
    scan.end()
    run.wait_for(BASE, {"Fine": False}, 10.0)
