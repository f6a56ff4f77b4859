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

from tests.checkouts import HERE
from tests.cli.command import run as eddi
from tests.connect.test_robots import consert, decided
from tests.data_files import data_file, data_text
from tests.e2e.robot import Run
from tests.e2e.workspace import Workspace
from tests.package_texts import loaded
from tests.ros1.world import PROBES, PYTHON, Probe, until

pytestmark = [pytest.mark.ros, pytest.mark.slow]
EXAMPLES = HERE / "examples"
PATIENCE_S = 30.0
EVENTS, DRIVE = "/motor/events", "/drive/guarantees"
SCOPE, LANDING = "/camera_scope/safeml", "/landing/guarantees"
RELIABILITY, MISSION = "/drone/reliability", "/drone/guarantees"
RISK, LOW, CROSSING = "/pedestrian/risk", "/pedestrian/risk/low", "/crossing/guarantees"
ROVER, BASE = "/rover/guarantees", "/base/guarantees"
STATE, DRIVING = "/shuttle/state", "/shuttle/guarantees"
TOPICS = (
    EVENTS, DRIVE, SCOPE, f"{SCOPE}/status", LANDING, RELIABILITY, MISSION, RISK, f"{RISK}/status",
    f"{RISK}/evidence", LOW, CROSSING, f"{CROSSING}/status", ROVER, BASE, STATE, DRIVING,
    "/diagnostics",
)  # fmt: skip
STREAM = Path(__file__).with_name("safeml_stream.py")
UNKNOWN, TRUE, FALSE = 1, 2, 0
FLYING = {"ContinueMission": True, "Land": True}
LANDED = {"ContinueMission": False, "Land": True}
NETWORK = "/pedestrian_prediction_example"
PERIOD_S, MAX_AGE_S = 0.1, 0.5
SLACK_S = 0.5  # transport and a machine that others use as well
EVIDENCE = f'{{id: RiskIsLow, node: Critical, state: "Yes", at_most: 0.35, topic: {LOW}}}'
CROSSING_MODEL = data_text("e2e/crossing.yml")
CROSSING_CONFIG = data_text("e2e/crossing_config.yml")


INPUTS = {"RightLaserStandby": None, "LeftLaserStandby": None, "DistanceAhead": "m"}
SCAN = {"range_max": 30.0, "angle_increment": 0.1, "angle_max": 0.2, "ranges": [1.0, 1.5, 9.0]}


class Kinds(Run):
    """One process listens to all topics and sends most of them: a `rostopic` each takes longer."""

    TOPICS = ()

    def __enter__(self):
        self.probe = Probe([PYTHON, str(PROBES / "ros1.py")], self.env, self.folder / "probe.log")
        for topic in TOPICS:
            self.probe.subscribe(topic, None)
        self.seen = 0
        return super().__enter__()

    def end(self):
        super().end()
        self.probe.destroy()

    def messages(self, topic):
        new = self.probe.events(self.seen)
        self.seen += len(new)
        for event in new:
            if event["event"] == "message":
                self.read.setdefault(event["topic"], []).append(event["data"])
        return self.read.get(topic, [])

    def send(self, topic, type_, fields, rate=20):
        """Repeat a message, faster than it grows too old; return what ends that."""
        self.probe.do("every", topic=topic, kind=type_, fields=fields, hz=rate)
        return lambda: self.probe.do("stop", topic=topic)

    def rostopic(self, topic, type_, data, rate=20):
        """The same from a process of its own."""
        return self._start("rostopic", "pub", "-r", str(rate), topic, type_, f"data: {data}")

    def truth(self, topic, value):
        return self.send(topic, "std_msgs/Bool", {"data": value})

    def of(self, topic, field):
        """Return a field of the last message, nothing before the first."""
        return [message[field] for message in self.messages(topic)[-1:]]

    def active(self, topic, guarantee):
        """Return the same of a guarantee."""
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
        "shuttle/driving.yml": ("shuttle_config.yml", "driving_config.yml"),
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
    def feed(topic, value):
        return run.send(topic, "std_msgs/Float32", {"data": value})

    def until_it_is(verdict, *, fast):
        until(lambda: run.of(EVENTS, "verdict") == [verdict], PATIENCE_S, f"event {verdict}")
        until(lambda: run.active(DRIVE, "FullSpeed") == [fast], PATIENCE_S, f"guarantee {fast}")

    until(lambda: run.messages(EVENTS), 60.0, "the first word of many nodes")
    until_it_is(UNKNOWN, fast=False)
    current = feed("/motor/current", 6)
    cool = feed("/motor/temperature", 55)
    until_it_is(TRUE, fast=True)
    cool()
    hot = feed("/motor/temperature", 95)
    until_it_is(FALSE, fast=False)
    hot()
    cool = feed("/motor/temperature", 55)
    until_it_is(TRUE, fast=True)
    current()  # silence is no evidence
    until_it_is(UNKNOWN, fast=False)
    cool()
    messages = run.messages(EVENTS)
    assert sum(message["raised"] for message in messages) == 2
    assert all(message["active"] == (message["verdict"] == TRUE) for message in messages)


def recorded():
    """Return the frames of the example's recording: usual ones, then those in fog."""
    lines = (EXAMPLES / "safeml" / "recording.csv").read_text().splitlines()
    cells = [line.partition(",")[2] for line in lines[1:]]
    frames = [[float(part) for part in cell.split()] for cell in cells if cell and '"' not in cell]
    whole = [frame for frame in frames if len(frame) == 6]
    return whole[:110], whole[110:]


def test_every_frame_of_the_camera_counts_once(workspace, run, tmp_path):
    usual, fog = recorded()
    chance = random.Random(4)
    for bad in [[]] * 5 + [[math.nan] * 6] * 5:
        usual.insert(chance.randrange(60, len(usual)), bad)
    frames = [*usual, *fog]
    (tmp_path / "frames.json").write_text(json.dumps(frames))
    monitor = loaded(workspace.packages / "camera_scope")[0].monitor
    offline = {}
    for frame in frames:
        result = monitor.execute_step(SimpleNamespace(frame=frame), 0)
        offline[result.accepted, result.rejected] = result

    def counts(status):
        return status["accepted"], status["rejected"]

    until(lambda: run.messages(SCOPE), PATIENCE_S, "the first word")
    assert run.messages(SCOPE)[0]["omission"] is True
    run._start(PYTHON, str(STREAM), str(tmp_path / "frames.json"))
    total = (len(frames) - 10, 10)
    came = lambda: total in {counts(one) for one in run.messages(f"{SCOPE}/status")[-10:]}  # noqa: E731
    until(came, 60.0, "all frames counted")
    until(lambda: run.active(LANDING, "PreciseLanding") == [False], 10.0, "the guarantee's end")
    assert any(state["PreciseLanding"] for state in run.states(LANDING))
    statuses = [one for one in run.messages(f"{SCOPE}/status") if not one["omission"]]
    assert len(statuses) > 30
    assert statuses[-1]["odd_violation"]
    for status in statuses:  # each verdict is the one that the same frames give without ROS
        expected = offline[counts(status)]
        assert status["statistic"] == pytest.approx(expected.statistic, rel=1e-9)
        assert status["threshold"] == expected.threshold


def test_from_the_rotor_to_the_guarantee(run):
    rotors = run.truth("/drone/rotors_ok", True)
    link = run.truth("/drone/link_lost", False)
    run.wait_for(MISSION, FLYING, 40.0)
    flying = run.messages(RELIABILITY)[-1]
    assert flying["evidence"] == [{"id": "RtE_continue", "active": True}]
    assert flying["p_fail"] == pytest.approx(5.155e-6, rel=1e-2)
    assert flying["p_fail_low"] == flying["p_fail_high"] == flying["p_fail"]
    link()  # silence: what is not known is no evidence
    run.wait_for(MISSION, LANDED, 10.0)
    silent = run.messages(RELIABILITY)[-1]
    assert (silent["valid"], silent["unknown_inputs"]) == (False, ["MissionLoss_Link"])
    run.truth("/drone/link_lost", False)
    run.wait_for(MISSION, FLYING, 10.0)
    rotors()
    run.truth("/drone/rotors_ok", False)
    until(lambda: run.messages(RELIABILITY)[-1]["p_fail"] > 1e-3, 10.0, "the jump")
    run.wait_for(MISSION, LANDED, 10.0)


def test_speed_and_distance_become_a_risk_and_that_a_guarantee(run):
    def until_it_is(value, *, low):
        def came():
            outcomes = [
                message["output_nodes"][0]["outcomes"][0]["outcome_value"]
                for message in run.messages(RISK)[-1:]
            ]
            return outcomes == [pytest.approx(value, abs=1e-6)]

        until(came, PATIENCE_S, f"a risk of {value}")
        until(lambda: run.of(LOW, "data") == [low], PATIENCE_S, f"evidence {low}")
        run.wait_for(CROSSING, {"Cross": low}, PATIENCE_S)

    until_it_is(0.3385, low=False)  # nothing is observed: the prior, below the limit
    speed = run.rostopic("/vehicle/speed", "std_msgs/Float64", 4 / 3.6)
    until_it_is(0.36, low=False)
    distance = run.send("/pedestrian/distance", "std_msgs/Float64", {"data": 0.4})
    until_it_is(0.7, low=False)
    distance()
    distance = run.rostopic("/pedestrian/distance", "std_msgs/Float64", 5.3)
    until_it_is(0.2, low=True)
    for sensor in (speed, distance):
        sensor.popen.kill()
    dead = time.time()
    run.wait_for(CROSSING, {"Cross": False}, PATIENCE_S)
    why = "threshold.RiskIsLow"
    # the probe that sent another distance is still there, and silent
    chains = ("/vehicle/speed: publisher gone ", "/pedestrian/distance: nothing for ")
    told = lambda: run.diagnosis(NETWORK).get(why, "")  # noqa: E731
    until(lambda: all(chain in told() for chain in chains), PATIENCE_S, why)
    # the last status that is TRUE is of a step before the limit, and a period of each monitor
    stamps = [
        status["header"]["stamp"]
        for status in run.messages(f"{CROSSING}/status")
        if status["guarantees"][0]["verdict"] == TRUE
    ]
    assert max(stamps) - dead <= MAX_AGE_S + 2 * PERIOD_S + SLACK_S
    unknown = "inactive: Cross <- RiskIsLow <- "
    said = lambda: run.diagnosis("/crossing").get("guarantee.Cross", "")  # noqa: E731
    until(lambda: said().startswith(unknown) and "/vehicle/speed: publisher gone" in said())


def test_a_fail_state_takes_the_guarantee_away(run):
    def number(topic, value):
        return run.send(topic, "std_msgs/Float32", {"data": value})

    dirt = number("/lidar/dirt", 0.05)
    number("/battery/level", 0.8)
    fault = run.truth("/drive/fault", False)
    run.truth("/wash/done", False)
    states = {"DriveFast": True, "Drive": True, "Stop": True}
    run.wait_for(DRIVING, states, PATIENCE_S)
    dirt()
    number("/lidar/dirt", 0.5)
    run.wait_for(DRIVING, {**states, "DriveFast": False}, PATIENCE_S)
    assert run.of(STATE, "state") == ["Slow"]
    raised = [one for message in run.messages(STATE) for one in message["raised"]]
    assert [(one["text"], one["certain"]) for one in raised] == [
        ("reduced speed", True),
        ("limit_speed", True),
    ]
    until(lambda: "limit_speed is due" in run.launch_text(), PATIENCE_S, "the function")
    fault()  # silence: it may have failed, and nothing but an order makes that certain again
    run.wait_for(DRIVING, {"DriveFast": False, "Drive": False, "Stop": True}, PATIENCE_S)
    assert run.of(STATE, "failed") == [UNKNOWN]
    run.truth("/drive/fault", False)
    said = lambda: run.diagnosis("/driving").get("guarantee.Drive", "")  # noqa: E731
    until(lambda: "Drive <- NothingFailed <- NotFailed" in said(), PATIENCE_S, "why")
    until(lambda: len(run.of(STATE, "possible")[0]) > 1, PATIENCE_S, "several states")
    reset = run.truth("/desk/restarted", True)
    until(lambda: run.of(STATE, "failed") == [FALSE], PATIENCE_S, "an order")
    reset()


def test_battery_and_motor_become_evidence(workspace, run):
    assert workspace.eddi_input("rover").read_text().count("self.expression(") == 2
    run.wait_for(ROVER, {"MayDrive": False}, PATIENCE_S)
    run.send("/battery", "sensor_msgs/BatteryState", {"present": True, "percentage": 0.8})
    motor = run.send("/motor/temperature", "std_msgs/Float32", {"data": 40.0})
    run.wait_for(ROVER, {"MayDrive": True}, PATIENCE_S)
    # Not at the other's rate: the monitor takes the last message of a step, and of two that
    # keep in step it could be the same one for ever.
    hot = run.rostopic("/motor/temperature", "std_msgs/Float32", 90.0, rate=97)
    run.wait_for(ROVER, {"MayDrive": False}, PATIENCE_S)
    hot.destroy()
    run.wait_for(ROVER, {"MayDrive": True}, PATIENCE_S)  # two seconds without heat
    motor()
    run.wait_for(ROVER, {"MayDrive": False}, PATIENCE_S)  # nobody knows how hot it is


def test_a_real_system_becomes_a_monitor_that_runs(run):
    run.wait_for(BASE, {"Fine": False}, 30.0)
    for side in ("left", "right"):
        run.truth(f"/base_laser_{side}/scan_standby", True)
    scan = run.send("/base_laser_front/scan", "sensor_msgs/LaserScan", SCAN)
    run.wait_for(BASE, {"Fine": True}, 30.0)
    scan()
    run.wait_for(BASE, {"Fine": False}, 10.0)
