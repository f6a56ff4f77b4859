"""``run`` with several packages, a workspace, or the robots of a deployment file."""

import shutil
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import pytest

from eddi_scaffold.common.files import read_source
from eddi_scaffold.packages.running import packages_in
from eddi_scaffold.recordings.csv_recording import Recording, Sample
from eddi_scaffold.recordings.members import read_values
from eddi_scaffold.recordings.node import blank
from eddi_scaffold.recordings.playing import play, played
from tests.cli.command import EXAMPLE, ROOT, edit, example, run
from tests.diagnosed import assert_reported

SECOND = 1_000_000_000
BOTH = ("two_conserts.xml", "-c", "consert_a_config.yml", "-c", "consert_b_config.yml")
DEMAND = "self.RtE_A_D0 = given(by_id(consertb.guarantees, 'System_A_G0_c2').active, True)"
NOT = "self.RtE_A_D0 = not consertb.guarantees[0].active"
SENSOR = "self.RtE_A_E0 = RtE_E0.data"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    shutil.copytree(EXAMPLE / "expected", tmp_path / "ws")
    return example(tmp_path)


def body(folder: Path, letter: str, old: str, new: str) -> None:
    name = f"consert{letter}"
    edit(folder / f"ws/src/eddi_monitor/{name}/src/{name}/EDDIInput.py", old, new)


def rows(path: Path, header: str, *lines: str) -> None:
    path.write_text("\n".join([f"t,{header}", *lines, ""]))


def told(folder: Path, *words: str, status: int = 0) -> list[str]:
    done = run("run", *words, "--inputs", "r.csv", cwd=folder)
    assert done.status == status, done.err
    return [" ".join(line.split()) for line in done.out.splitlines()]


ACTIVE = "ConSertA: System_A_G0 active System_A_G1 active"
FIRST = ["0.000 ConSertB: System_A_G0_c2 active", f"0.000 {ACTIVE}"]


@pytest.mark.parametrize("header", ["/rte/e0a,/rte/e0b", "ConSertA.RtE_A_E0,ConSertB.RtE_A_E0"])
def test_a_workspace_runs_with_its_code(folder: Path, header: str) -> None:
    """Publishers first, and what they publish counts in the same step; others need no code."""
    rows(folder / "r.csv", header, "0,true,true", "0.3,true,false", "0.5,true,false")
    assert told(folder, "-w", "ws")[:2] == FIRST
    body(folder, "a", DEMAND, NOT)
    with_code = [
        "0.300 ConSertB: System_A_G0_c2 inactive <- RtE_A_E0 <- /rte/e0b: false for 0.0 s",
        f"0.300 {ACTIVE}",
    ]
    chain = "<- RtE_A_D0 <- System_A_G0_c2: true for 0.0 s"
    inactive = f"0.000 ConSertA: System_A_G0 active System_A_G1 inactive {chain}"
    packages = [f"ws/src/eddi_monitor/consert{letter}" for letter in "ab"]
    for words in [("-w", "ws"), packages, ("ws/src/eddi_monitor",), (*BOTH, "-w", "ws")]:
        assert told(folder, *words) == [FIRST[0], inactive, *with_code], words
    for words in [("-w", "ws", "--no-code"), BOTH]:
        assert told(folder, *words)[:2] == FIRST, words


def test_of_a_workspace_only_what_is_asked_for_is_executed(folder: Path) -> None:
    trap = folder / "executed"
    body(folder, "b", SENSOR, f"open({str(trap)!r}, 'w')")
    rows(folder / "r.csv", "RtE_A_D0,RtE_A_E0", "0,true,true")
    done = run("run", *BOTH[:3], "-w", "ws", "--inputs", "r.csv", cwd=folder)
    assert "with the code of ConSertA;" in done.err
    assert not trap.exists()
    done = run("run", "-w", "ws", "--no-code", "--inputs", "r.csv", cwd=folder)
    assert "the code of" not in done.err


def test_the_first_exception_of_each_input_is_told(folder: Path) -> None:
    for letter in "ab":
        body(folder, letter, SENSOR, "self.RtE_A_E0 = RtE_E0.value")
    rows(folder / "r.csv", "/rte/e0a,/rte/e0b", "0,true,", "0.5,,true", "1,true,true")
    done = run("run", "-w", "ws", "--inputs", "r.csv", cwd=folder)
    for letter, time in [("a", "0.000"), ("b", "0.500")]:
        place = f"consert{letter}/src/consert{letter}/EDDIInput.py:"
        assert [time in line for line in done.err.splitlines() if place in line] == [True]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("return (", "return  ("), "was changed after it was generated"),
        (("consert: 3}", "consert: 99}"), "upgrade"),
        (('digest = "', 'digest = "0'), "was changed after it was generated"),
    ],
)
def test_another_compiled_monitor_is_refused(
    folder: Path, change: tuple[str, str], words: str
) -> None:
    edit(folder / "ws/src/eddi_monitor/consertb/src/consertb/compiled.py", *change)
    rows(folder / "r.csv", "/rte/e0a,/rte/e0b", "0,true,true")
    done = run("run", "-w", "ws", "--inputs", "r.csv", cwd=folder)
    assert (done.status, done.out) == (2, "")
    assert_reported("I020", done.err)
    assert words in done.err


def test_two_of_one_name_and_topic_are_refused(folder: Path) -> None:
    package = "ws/src/eddi_monitor/consertb"
    shutil.copytree(folder / package, folder / "other" / "consertb")
    rows(folder / "r.csv", "/rte/e0b", "0,true")
    done = run("run", package, "other/consertb", "--inputs", "r.csv", cwd=folder)
    assert done.status == 2
    assert "[G004]" in done.err
    assert "[D005]" in done.err


def test_nothing_runs_where_no_monitor_is(folder: Path) -> None:
    rows(folder / "r.csv", "/rte/e0b", "0,true")
    told(folder, "ws/src/eddi_monitor/eddi_messages", status=2)
    told(folder, "ws/src/eddi_monitor/consertb", "-c", "consert_b_config.yml", status=2)
    told(folder, str(ROOT / "examples/two-robots/deployment.yml"), "--name", "am", status=2)


LINK = """
Model: {id: NAME, type: ConSert, frequency: 10, model: NAME.yml}
SimulatorOutputs: [{id: source, type: TYPE, topic: TOPIC}]
EDDIInputs: [{id: ok, requires: [source], FIELD, max_age: 1 s}]
EDDIOutputs: [{id: out, topic: NAME/out}]
"""


def plain(folder: Path, name: str, source: str, message: str, how: str) -> str:
    """Generate a monitor of plain Python into a folder of its own."""
    place = folder / f"out_{name}"
    place.mkdir()
    (place / f"{name}.yml").write_text("evidence: {ok: bool}\nguarantees: {G: ok}\n")
    text = LINK.replace("NAME", name).replace("TYPE", message).replace("TOPIC", source)
    (place / "c.yml").write_text(text.replace("FIELD", how))
    done = run("generate", "--platform", "plain", "-o", place, "-c", "c.yml", cwd=place)
    assert done.status == 0, done.err
    return f"out_{name}/{name}"


OF_MONITOR = ("eddi_messages/ConSertOutput", "field: 'guarantees[G].active'")
OF_SENSOR = ("std_msgs/Bool", "field: data")


@pytest.mark.slow
def test_plain_packages_are_joined_or_refused(tmp_path: Path) -> None:
    near = plain(tmp_path, "near", "far/out", *OF_MONITOR)
    far = plain(tmp_path, "far", "/sensor", *OF_SENSOR)
    rows(tmp_path / "r.csv", "/sensor", "0,true", "0.2,false")
    assert told(tmp_path, near, far) == [
        "0.000 far: G active", "0.000 near: G active",
        "0.200 far: G inactive <- ok <- /sensor: false for 0.0 s",
        "0.200 near: G unknown <- ok <- G <- ok <- /sensor: false for 0.0 s",
    ]  # fmt: skip
    shutil.rmtree(tmp_path / "out_far")
    far = plain(tmp_path, "far", "near/out", *OF_MONITOR)
    done = run("run", near, far, "--inputs", "r.csv", cwd=tmp_path)
    assert (done.status, "[D003]" in done.err) == (2, True)
    for file in [*tmp_path.rglob("near/compiled.py"), *tmp_path.rglob("consert/__init__.py")]:
        file.write_text(file.read_text().replace("consert: 3}", "consert: 9}"))
        file.write_text(file.read_text().replace("FORMAT = 3", "FORMAT = 9"))
    done = run("run", near, "--inputs", "r.csv", cwd=tmp_path)
    assert (done.status, "run `eddi-scaffold upgrade`" in done.err) == (2, True)


def test_robots_hear_each_other_for_the_lease(tmp_path: Path) -> None:
    """A word counts once it answers one of the listener; it ends with what it rests on."""
    sensors = "/arm/joints/at_rest,/arm/joints/braked,/cart/scanner/free"
    times = [k / 10 for k in range(80)]
    alive = [f"{t},true,true,true" if not 3 <= t < 6 else f"{t},,,true" for t in times]
    rows(tmp_path / "r.csv", sensors, *alive)
    lines = told(tmp_path, str(ROOT / "examples/two-robots/deployment.yml"))
    of_cart = [line.split(" <-")[0] for line in lines if " cart/cart: " in line]
    assert of_cart == [
        f"{t} cart/cart: Drive {drive} Wait active"
        for t, drive in [
            ("0.000", "unknown"), ("0.100", "active"), ("3.500", "unknown"), ("6.000", "active"),
        ]
    ]  # fmt: skip


class Word:
    """A word as rosbags reads it: of a robot that is not played."""

    def __init__(self, **fields: object) -> None:
        vars(self).update(fields)


def test_recorded_words_count_for_their_lease(tmp_path: Path) -> None:
    """One robot alone, and what another one said: as if it had answered this one."""
    deployment = ROOT / "examples/two-robots/deployment.yml"
    (cart,), _ = packages_in([]).with_robots(read_source(deployment), "cart")
    assert cart.fleet is not None
    rows(tmp_path / "r.csv", "/cart/scanner/free", *(f"{k / 10},true" for k in range(60)))
    (cart,), recording, _ = read_values(read_source(tmp_path / "r.csv"), [cart])
    cart = replace(cart, columns={})  # the demand is no column
    parked = blank("eddi_messages/RobotGuarantee")
    parked.id, parked.active = "Parked", True
    arm = {"robot": "arm", "model_id": "arm", "model_digest": cart.fleet.sources[0].digest}
    arm |= {"session": "recorded", "lease": 1.0, "listens": False, "heard": []}
    words = [Word(**arm, guarantees=[parked], sequence=k) for k in range(20)]
    heard = [Sample(k * SECOND // 10, cart.fleet.topic, word) for k, word in enumerate(words)]
    samples = sorted([*recording.samples, *heard], key=lambda sample: sample.t)
    whole = Recording(0, recording.end, tuple(samples), recording.rows)
    active: Mapping[float, bool] = {
        step.t: {row["id"]: row["active"] for row in step.output}["Drive"]
        for _, step in play(played([cart]), whole)
    }
    assert [t for t, driving in active.items() if driving] == [k / 10 for k in range(1, 29)]
