"""Faults in recordings: what is measured beside its bound; the reference is ``data/evidence``."""

import json
import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from random import Random

import pytest
import yaml
from hypothesis import settings

from eddi_scaffold.cli.run import recorded
from eddi_scaffold.config.schema import FAULTS, Reaction
from eddi_scaffold.deployments.injection import Injector, Row
from eddi_scaffold.deployments.lifetimes import times_of_claims
from eddi_scaffold.deployments.support import wired
from eddi_scaffold.kinds.consert.options import ConSertOptions
from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.recordings.csv_recording import Recording
from eddi_scaffold.recordings.members import Member
from eddi_scaffold.recordings.node import Message
from tests.cli.command import ROOT, run
from tests.data_files import tabled, write_files
from tests.deployments.injection.drawn import drawn

DATA = ROOT / "tests" / "data" / "evidence"
RUN_MS = {"gripper": 300, "tug": 600, "crane": 450}
"""From the last good message to the loss in the phases of ``run``, by the reference."""
BAD = {"Force": False, "Door": False, "gap": 0.5, "Brake": False, "wind": 30.0, "Hook": False}


def case_of(name: str) -> tuple[dict, list[Member], Recording]:
    folder = DATA / f"reaction_{name}"
    options = {"-c": (), "--name": None, "-g": (), "--system": None, "--models": None}
    files = sorted(folder.glob("*_config.yml"))
    members, recording = recorded(files, folder / "inputs.csv", None, None, options, code=False)
    return yaml.safe_load((folder / "case.yml").read_text("utf-8")), members, recording


def rows_of(
    members: Sequence[Member], recording: Recording, of: str, reaction: Reaction
) -> dict[tuple[str, str], Row]:
    reacting = []
    for member in members:
        monitor, config = member.monitor, member.monitor.config
        held = [reaction] if monitor.id == of else []
        config = replace(config, config=config.config.model_copy(update={"Reactions": held}))
        reacting.append(replace(member, monitor=replace(monitor, config=config)))
    rows = Injector(reacting, recording, 8).rows(FAULTS)
    return {(row.fault.partition(" ")[0], row.topic): row for row in rows}


def with_bad_values(recording: Recording) -> Recording:
    """Return a recording where every topic in turn is bad for a while, behind what is good."""
    good = {sample.topic: sample.message for sample in reversed(recording.samples)}
    step, long = 50_000_000, 4_000_000_000
    samples = []
    for t in range(0, long * (len(good) + 1), step):
        for number, (topic, message) in enumerate(good.items()):
            begin = long * (number + 1)
            name = topic.rpartition(".")[2]
            bad = begin <= t < begin + long // 4
            sample = replace(recording.samples[0], t=t, topic=topic, message=message)
            samples.append(replace(sample, message=BAD[name]) if bad else sample)
    return Recording(0, long * (len(good) + 1), tuple(samples))


@pytest.mark.parametrize("name", RUN_MS)
def test_bounds_and_what_is_measured_agree_with_the_reference(name: str) -> None:
    case, members, recording = case_of(name)
    monitors = [wired(member.monitor) for member in members]
    claim = f"{case['guarantee_of']}.{case['guarantee']}"
    bounds = {"silence": "silence", "bad_value": "value"}
    rows = rows_of(
        members,
        with_bad_values(recording),
        case["guarantee_of"],
        Reaction(
            guarantee=case["guarantee"], ftti=9.0, reaction=0.0, faults=["drop", "delay 1 ms"]
        ),
    )
    for effect, (bound_ms, measured_ms) in case["want"].items():
        kind, topic = effect.split()
        times = times_of_claims(monitors, bounds[kind])[claim]
        assert round(times[topic][0] * 1000, 6) == bound_ms, effect
        row = rows["drop" if kind == "silence" else "delay", topic]
        late_ms = 0 if kind == "silence" else 1
        assert row.bound_s == pytest.approx((bound_ms + late_ms) / 1000), effect
        assert (row.verdict, row.phases > 0) == ("met", True), effect
        assert row.measured_s <= row.bound_s + 1e-6
        if kind == "silence":
            assert row.measured_s == pytest.approx(measured_ms / 1000), effect
        else:  # the mean of the reference is gone when the whole window is bad: here it is 30 m/s
            assert row.measured_s >= 0.6 * measured_ms / 1000, effect
    for effect, ftti_ms in case["ftti"].items():
        kind, topic = effect.split()
        row = rows["drop" if kind == "silence" else "delay", topic]
        bound_s = row.bound_s if kind == "silence" else row.bound_s - 0.001
        judged = replace(row, bound_s=round(bound_s, 9), within_s=ftti_ms / 1000)
        assert judged.verdict == case["ftti_verdicts"][effect], effect
    silent = {"gripper": "/force", "tug": "/gap", "crane": "/wind"}[name]
    assert rows["drop", silent].measured_s >= RUN_MS[name] / 1000


def test_what_nothing_bounds_is_never_met() -> None:
    _, members, recording = case_of("tug")
    faults = ["freeze", "bias 2", "scale 1000", "scale 1.2"]
    reaction = Reaction(guarantee="Tow", ftti=99.0, reaction=0.0, faults=faults)
    rows = rows_of(members, with_bad_values(recording), "tug", reaction)
    assert {row.verdict for row in rows.values()} == {"no bound"}
    assert {row.topic for key, row in rows.items() if key[0] == "bias"} == {"/gap"}  # a number
    frozen, biased = rows["freeze", "/gap"], rows["bias", "/gap"]
    assert (frozen.measured_s, frozen.phases, biased.measured_s) == (None, 8, None)  # 0.5 m + 2 m
    assert not any(row.is_accepted for row in rows.values())
    accepted = replace(frozen, accept="the driver counts")
    assert (accepted.verdict, accepted.is_accepted) == ("no bound", True)
    missed = replace(accepted, bound_s=100.0)  # no reason makes a time shorter
    assert (missed.verdict, missed.is_accepted) == ("missed", False)


def test_a_topic_that_is_not_needed_is_not_exercised(tmp_path: Path) -> None:
    files = {
        "m.yml": "evidence: {a: bool, b: bool}\nguarantees: {G: a OR b}\n",
        "c.yml": "Model: {id: m, type: ConSert, model: m.yml, frequency: 10}\n"
        "SimulatorOutputs:\n- {id: a, type: std_msgs/Bool, topic: /a}\n"
        "- {id: b, type: std_msgs/Bool, topic: /b}\n"
        "EDDIInputs:\n- {id: a, from: a, max_age: 0.3 s}\n- {id: b, from: b, max_age: 0.3 s}\n"
        "Reactions:\n"
        "- {guarantee: G, ftti: 2 s, reaction: 1 s, faults: [drop], accept: one is enough}\n",
        "r.csv": "t,a,b\n" + "".join(f"{k / 10},true,true\n" for k in range(60)),
    }
    done = run("inject", "c.yml", "--inputs", "r.csv", cwd=write_files(tmp_path, files))
    assert done.status == 0, done.err
    assert "not exercised, accepted: one is enough" in done.out


def test_words_of_another_robot_are_dropped_like_messages(tmp_path: Path) -> None:
    files = {path.name: path.read_text() for path in (ROOT / "examples/two-robots").glob("*.yml")}
    reaction = "{guarantee: Drive, ftti: 3 s, reaction: 1 s, faults: [drop, nan]}"
    files["cart_config.yml"] += f"Reactions: [{reaction}]\n"
    rows = "".join(f"{k / 10},true,true,true\n" for k in range(80))
    files["r.csv"] = f"t,/arm/joints/at_rest,/arm/joints/braked,/cart/scanner/free\n{rows}"
    folder = write_files(tmp_path, files)
    done = run("-q", "inject", "deployment.yml", "--inputs", "r.csv", "--json", cwd=folder)
    assert done.status == 0, done.err
    rows_ = {(row["fault"], row["topic"]): row for row in json.loads(done.out)["rows"]}
    assert ("nan", "/eddi/peers") not in rows_
    assert rows_["drop", "/eddi/peers"]["measured_s"] == 1.1  # the lease and a period


def test_what_cannot_be_lost_is_no_guarantee_of_reactions(tmp_path: Path) -> None:
    robot = ROOT / "examples" / "warehouse-robot"
    files = {path.name: path.read_bytes() for path in robot.iterdir() if path.is_file()}
    files["robot.yml"] = files["robot.yml"].replace(
        b"guarantee: FullSpeed", b"guarantee: StandStill"
    )
    done = run("inject", "robot.yml", "--inputs", "faults.csv", cwd=write_files(tmp_path, files))
    assert (done.status, "no claim 'StandStill'" in done.err) == (2, True)


SEEDS = 600 if settings.default.max_examples > 1000 else 5


@pytest.mark.parametrize("seed", range(SEEDS))
def test_nothing_outlives_its_bound(seed: int, tmp_path: Path) -> None:
    """Random monitors of every kind; the long profile injects more than 10,000 faults."""
    members, recording = drawn(Random(f"injection {seed}"), tmp_path)
    for row in Injector(members, recording, 6).rows(FAULTS):
        assert row.bound_s is None or row.measured_s is None or row.measured_s < row.bound_s + 1e-6
        assert row.bound_s is not None or row.verdict == "no bound"
        assert not row.fault.startswith("freeze") or row.verdict == "no bound"


REACTIONS = "Reactions: [{guarantee: Grasp, ftti: 0.9 s, reaction: 0.3 s, faults: [drop, nan]}]\n"


@pytest.fixture
def gripper(tmp_path: Path) -> Path:
    folder = DATA / "reaction_gripper"
    return write_files(tmp_path, {path.name: path.read_bytes() for path in folder.iterdir()})


@tabled
def test_status(reactions: str, words: list[str], status: int, told: str, gripper: Path) -> None:
    config = gripper / "gripper_config.yml"
    config.write_text(config.read_text("utf-8") + reactions, "utf-8")
    done = run("inject", config.name, "--inputs", "inputs.csv", *words, cwd=gripper)
    assert done.status == status, done.out + done.err
    assert told in done.out + done.err


def test_a_bound_that_is_exceeded_is_a_bug_of_ours(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ConSertOptions, "hold_s", lambda *_: 0.0)
    files = {path.name: path.read_bytes() for path in (DATA / "reaction_tug").iterdir()}
    more = "Reactions: [{guarantee: Tow, ftti: 0.9 s, reaction: 0.3 s, faults: [drop]}]\n"
    files["tug_config.yml"] += more.encode()
    configs = [name for name in files if name.endswith("_config.yml")]
    folder = write_files(tmp_path, files)
    done = run("inject", *configs, "--inputs", "inputs.csv", cwd=folder)
    assert done.status == 70
    assert "tug.Tow outlives drop of /brake at" in done.err
    assert "its bound is 0.7 s" in done.err


def test_json_is_for_the_report(gripper: Path) -> None:
    config = gripper / "gripper_config.yml"
    config.write_text(config.read_text("utf-8") + REACTIONS, "utf-8")
    words = ("--inputs", "inputs.csv", "--phases", "2", "--json", "--faults", "drop")
    done = run("inject", config.name, *words, cwd=gripper)
    told = json.loads(done.out)
    assert (told["format"], told["recording"], told["phases"]) == (1, "inputs.csv", 2)
    assert [of["monitor"] for of in told["monitors"]] == ["gripper"]
    assert told["rows"][0] == {
        "monitor": "gripper", "guarantee": "Grasp", "hazard": None, "fault": "drop",
        "topic": "/door", "ftti_s": 0.9, "reaction_s": 0.3, "within_s": 0.6, "bound_s": 0.5,
        "phases": 2, "measured_s": 0.5, "accept": None, "verdict": "met",
        "accepted": False,
    }  # fmt: skip


def test_messages_lose_their_numbers_and_keep_their_form() -> None:
    from eddi_scaffold.recordings.faults import is_number, without_values

    scan = Message(header=Message(seq=3), ranges=[1.0, 2], name="x", ok=True, message_type="S")
    bare = without_values(scan)
    assert (bare.header.seq, bare.name, bare.ok, bare.message_type) == (3, None, None, "S")
    assert [value != value for value in bare.ranges] == [True, True]  # noqa: PLR0124 - NaN
    assert (scan.ranges, is_number(scan), is_number(True), is_number(3)) == (
        [1.0, 2],
        True,
        False,
        True,
    )


@pytest.mark.parametrize(("release", "more", "seconds"), [
    (0.15, "", 0.6), (0.25, "", math.inf), (0.1, "", 0.6), (0.1, ", hysteresis: 0.05", math.inf),
])  # fmt: skip
def test_a_probability_between_its_limits_stays(
    release: float, more: str, seconds: float, tmp_path: Path
) -> None:
    """A match below 0.7 makes it 0.2, a slip above 0.05 makes it 0.3; none is between."""
    robot = ROOT / "examples" / "warehouse-robot"
    files = {path.name: path.read_bytes() for path in robot.iterdir() if path.is_file()}
    text = files["robot.yml"].decode().replace("release: 0.15", f"release: {release}")
    files["robot.yml"] = text.replace("bins: [0.7]", f"bins: [0.7]{more}").encode()
    monitors, _ = monitors_of(None, [write_files(tmp_path, files) / "robot.yml"], "localisation")
    times = times_of_claims([wired(monitors[0])], "silence")
    assert times["localisation.PoseIsGood"]["/wheels/slip"][0] == pytest.approx(seconds)
