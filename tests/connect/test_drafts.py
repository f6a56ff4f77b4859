"""Drafts: what is written for each kind of model, and what stays when a person has edited it."""

import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import EddiError
from eddi_scaffold.config.file import undecided
from eddi_scaffold.config.topic_block import ConfigText, read_block
from eddi_scaffold.connect.draft import Age, entry, recorded_age
from eddi_scaffold.connect.keeping import Draft, text_of, with_draft
from eddi_scaffold.connect.matching import decide
from eddi_scaffold.connect.topics import InputNeed, RobotTopic, TopicField, leaves
from eddi_scaffold.yaml_text.nodes import Items, Map, read_map
from tests.cli.command import ROOT, Result, files_below, run
from tests.data_files import data_text, tabled
from tests.hostile_texts import HOSTILE

TYPES = {
    "std_msgs/Bool": {"data": "bool"},
    "rover_msgs/Charge": {"level": "float32"},
    "rover_msgs/Loop": {"again": "rover_msgs/Loop", "also": "rover_msgs/Loop[]", "end": "bool"},
}
CLEAR = RobotTopic("clear", "std_msgs/Bool", "/front/clear")
CHARGE = RobotTopic("charge", "rover_msgs/Charge", "/power/charge")
WAY = InputNeed("WayIsClear", "bool")
POWER = InputNeed("Charge", "float")


def draft(
    needs: list[InputNeed], topics: list[RobotTopic], ages: dict[str, Age] | None = None
) -> Draft:
    """Return what is drafted for some inputs."""
    entries = [entry(one, ages or {}) for one in decide(needs, topics, TYPES.get)]
    model = {"id": "Rover", "type": "ConSert"}
    return Draft(model, {}, {}, entries)


def written(text: str, wanted: Draft) -> str:
    """Return the text with the draft, for which a second time changes nothing."""
    after = with_draft(document(text), wanted)
    assert with_draft(document(after), wanted) == after
    return after


def document(text: str) -> ConfigText:
    return read_block(Source("c.yml", text.encode()))


def content(text: str) -> Map:
    node, problems = read_map(Source("c.yml", text.encode()), "K001")
    assert node is not None
    assert not problems
    return node


def test_what_a_person_decided_stays_and_the_rest_is_decided_anew() -> None:
    mine = data_text("connect/decided_by_a_person.yml")
    after = written(mine, draft([WAY, POWER, InputNeed("Speed", "float")], [CLEAR, CHARGE]))
    kept = [line for line in mine.splitlines(keepends=True) if "# connect:" not in line]
    now = after.splitlines(keepends=True)
    assert [one for one in kept if one not in now] == ["  expression: TODO\r\n"]
    assert "  from: charge.level\r\n  max_age: 5   # measured\r\n" in after
    assert "- id: Speed\r\n  # connect: no topic fits\r\n  from: TODO  # TODO" in after
    assert after.count("\n") == after.count("\r\n")
    assert "WayIsClear\r\n  # my reason" in after  # the reasons for what was not taken are gone


def test_comments_of_a_person_behind_what_is_open_stay() -> None:
    mine = data_text("connect/comments_of_a_person.yml")
    after = written(mine, draft([WAY, InputNeed("Speed", "float")], [CLEAR]))
    words = ("one", "two", "three", "four", "five", "six", "seven", "eight")
    assert [word for word in words if after.count(word) != 1] == []
    assert "  # TODO ask two\n  from: clear.data\n  # three\n" in after
    assert "  max_age: TODO  # TODO seconds six\n" in after
    assert "  # seven\n  from: TODO  # TODO no topic is known\n" in after


def test_a_pause_of_a_recording_is_none_of_the_rate() -> None:
    second = 1_000_000_000
    steady = [k * second // 10 for k in range(50)]
    pause = [*steady, *(one + 11 * second for one in steady)]
    assert recorded_age(steady, "a.bag") == Age(0.25, "50 messages of a.bag")
    why = "100 messages of a.bag, without 1 gap of up to 6.1 s"
    assert recorded_age(pause, "a.bag") == Age(0.25, why)
    irregular = [start * 9 * second + k for start in range(9) for k in range(9)]
    assert recorded_age(irregular, "a.bag") is None


def test_a_list_in_brackets_is_refused_only_where_it_would_grow() -> None:
    whole = "Model: {id: Rover, type: ConSert}\nEDDIInputs: [{id: WayIsClear, requires: [x]}]\n"
    assert written(whole, draft([WAY], [CLEAR])).startswith(whole)
    with pytest.raises(EddiError) as refused:
        with_draft(document(whole), draft([WAY, POWER], [CLEAR]))
    assert [one.code for one in refused.value.problems] == ["K001"]


EVIL = [one for one in HOSTILE if "\ud800" not in one]  # no file has that


@pytest.mark.parametrize("evil", [*EVIL, 'x\n# connect: y\u2028EDDIOutputs: [] # "*&!', "TODO"])
def test_names_of_models_stay_data(evil: str) -> None:
    topics = [RobotTopic(evil, f"b/{evil}", evil), RobotTopic("c", "std_msgs/Bool", evil)]
    needs = [InputNeed(evil, "bool"), InputNeed("Charge", "float", unit=evil, description=evil)]
    options = {evil or "-": {"map": {evil: evil}}, "later": {evil: {"bins": "TODO"}}}
    notes = {("later", evil, "bins"): evil}
    text = written("", replace(draft(needs, topics), options=options, notes=notes))
    root = content(text)
    assert root.keys() == ["Model", "EDDIInputs"]
    entries, model = root.get("EDDIInputs"), root.get("Model")
    assert isinstance(entries, Items)
    assert isinstance(model, Map)
    assert [text_of(one, "id") for one in entries.items] == [evil, "Charge"]
    assert model.keys() == ["id", "type", evil or "-", "later"]
    assert "K059" in [one.code for one in undecided(root)]
    assert not any(one.message.endswith(".id") for one in undecided(entries))
    keys = {"id", "from", "requires", "field", "expression", "unit", "max_age"}
    assert all(keys.issuperset(one.keys()) for one in entries.items if isinstance(one, Map))


def test_options_are_added_where_they_are_missing() -> None:
    options = {"discretisation": {"Speed": {"bins": "TODO"}, "Near": {"bins": "TODO"}}}
    wanted = Draft({}, options, {("discretisation", "Near", "bins"): "2 edges"}, [])
    mine = "Model:\n  id: N\n  type: BN\n  discretisation:\n    Speed: {bins: [1]}  # mine\n"
    assert written(mine, wanted).splitlines()[4:7] == [
        "    Speed: {bins: [1]}  # mine", "    Near:", "      bins: TODO  # TODO 2 edges"
    ]  # fmt: skip


def test_messages_inside_of_themselves_end() -> None:
    found = leaves("rover_msgs/Loop", TYPES.get)
    assert [one.text for one in found] == ["end"]
    assert leaves("gone_msgs/Gone", TYPES.get) == [TopicField((), "", None)]


EXAMPLES = [
    ("robot-models", "Rover.yml", "eddi_config.yml", [], 3),
    ("pedestrian", "pedestrian.xml", "eddi_config.yml", [], 5),
    ("drone", "drone.xml", "reliability_config.yml", ["--name", "MissionLoss"], 3),
    ("safeml", "safeml_config.yml", "perception_config.yml", [], 1),
    ("motor-watch", "motor_watch.events", "motor_config.yml", [], 0),
    ("shuttle", "shuttle.xml", "shuttle_config.yml", [], 9),
]


def laid(example: str, config: str, folder: Path) -> None:
    """Put an example into a folder, with nothing but the topics in ``draft.yml``."""
    shutil.copytree(ROOT / "examples" / example, folder, dirs_exist_ok=True)
    lines = (folder / config).read_text("utf-8").split("SimulatorOutputs:\n")
    topics = lines[1].partition("EDDIInputs:")[0] if len(lines) > 1 else ""
    (folder / "draft.yml").write_text(f"SimulatorOutputs:\n{topics}" if topics else "", "utf-8")


def connect(folder: Path, model: str, *words: str) -> Result:
    system = ("--system", "rover.rossystem", "--models", "nodes") if model == "Rover.yml" else ()
    return run("connect", model, "-o", "draft.yml", *system, *words, cwd=folder)


@pytest.mark.parametrize(("example", "model", "config", "words", "count"), EXAMPLES)
def test_every_kind_gets_a_draft_that_says_what_is_open(
    example: str, model: str, config: str, words: list[str], count: int, tmp_path: Path
) -> None:
    laid(example, config, tmp_path)
    assert connect(tmp_path, model, *words).status == 0
    text = (tmp_path / "draft.yml").read_text("utf-8")
    checked = run("check", "draft.yml", cwd=tmp_path)
    assert (checked.status, checked.err.count(" error: ")) == (int(count > 0), count)
    assert checked.err.count("[K059]") == count == text.count(": TODO  # TODO ")
    again = connect(tmp_path, model, *words)
    assert again.err.endswith("draft.yml is up to date\n")
    assert (tmp_path / "draft.yml").read_text("utf-8") == text
    if example != "robot-models":  # its configuration names topics of its own
        before = (tmp_path / config).read_bytes()
        done = run("connect", model, "-o", config, *words, cwd=tmp_path)
        assert (done.status, "; 0 values" in done.err) == (0, True)
        assert (tmp_path / config).read_bytes() == before


def test_the_inputs_of_a_chain_follow_from_what_is_observed(tmp_path: Path) -> None:
    laid("drone", "reliability_config.yml", tmp_path)
    connect(tmp_path, "drone.xml", "--name", "MissionLoss")
    path = tmp_path / "draft.yml"
    text = path.read_text("utf-8")
    for key, value in {
        "horizon": "30 min",
        "observe": "{Healthy: rotors_ok, Crashed: not rotors_ok}",
        "events": "{}",
    }.items():
        head, _, rest = text.partition(f"{key}: TODO")
        text = f"{head}{key}: {value}\n{rest.partition(chr(10))[2]}"
    path.write_text(text, "utf-8")
    assert connect(tmp_path, "drone.xml").status == 0
    assert "  - id: rotors_ok\n    # connect: taken" in path.read_text("utf-8")


def test_evidence_of_another_name_is_left_to_a_person(tmp_path: Path) -> None:
    shutil.copytree(ROOT / "examples" / "warehouse-robot", tmp_path, dirs_exist_ok=True)
    robot = tmp_path / "robot.yml"
    robot.write_text(robot.read_text("utf-8").rpartition("---\n")[0], "utf-8")
    done = run("connect", "warehouse.yml", "--with", "robot.yml", cwd=tmp_path)
    entries = dict(part.split("\n", 1) for part in done.out.split("  - id: ")[1:])
    assert "    from: lidar.active\n" in entries["PathClear"]
    first = {
        "PowerHolds": '"power.evidence[LastsTheShift].active" 25 points',
        "Localised": '"localisation.evidence[PoseIsGood].active" 30 points',
        "PeopleAreSeen": "people.in_scope 25 points",
    }
    for name, text in first.items():
        assert f"# connect: from: {text}" in entries[name].splitlines()[1]
        assert "from: TODO  # TODO one of the above" in entries[name]


def test_a_topic_of_another_monitor_is_added_once(tmp_path: Path) -> None:
    shutil.copytree(ROOT / "examples" / "two-conserts", tmp_path, dirs_exist_ok=True)
    mine = "SimulatorOutputs:   # mine\n- {id: RtE_E0, type: std_msgs/Bool, topic: /rte/e0a}\n"
    (tmp_path / "a.yml").write_text(mine, "utf-8")
    words = ("connect", "two_conserts.xml", "--name", "ConSertA", "--with", "consert_b_config.yml")
    assert run(*words, "-o", "a.yml", cwd=tmp_path).status == 0
    text = (tmp_path / "a.yml").read_text("utf-8")
    assert f"{mine}- id: consertb\n  type: eddi_messages/ConSertOutput\n" in text
    assert run(*words, "-o", "a.yml", cwd=tmp_path).err.endswith("a.yml is up to date\n")


SCANNERS = data_text("connect/scanners.yml")


def test_comments_of_variables_and_synonyms_of_a_robot_are_read(tmp_path: Path) -> None:
    events = (
        "// What lies in front of the robot.\nVAR nearest : NUMBER UNIT m TIMEOUT 300ms\n"
        "VAR rotor : BOOL\n"
        "EVENT Clear (EVIDENCE) := nearest > 1 m AND rotor\n"
    )
    (tmp_path / "way.events").write_text(events, "utf-8")
    (tmp_path / "draft.yml").write_text(SCANNERS, "utf-8")
    assert run("connect", "way.events", "-o", "draft.yml", cwd=tmp_path).status == 0
    text = (tmp_path / "draft.yml").read_text("utf-8")
    assert '  from: "MIN(front.ranges[*], COVERAGE 0.9)"\n' in text
    assert "max_age: 0.3 s  # TIMEOUT of the model\n" in text
    assert "    from: spins.data\n" in text
    (tmp_path / "draft.yml").write_text(text.replace("max_age: TODO", "max_age: 0.5"), "utf-8")
    checked = run("check", "draft.yml", cwd=tmp_path)
    assert (checked.status, " error: " in checked.err) == (0, False)


def test_an_input_that_is_a_state_gets_a_condition_for_each(tmp_path: Path) -> None:
    laid("pedestrian", "eddi_config.yml", tmp_path)
    wanted = "EDDIInputs:\n- id: AV_Shuttle_Speed\n"
    (tmp_path / "draft.yml").write_text(wanted, "utf-8")
    assert connect(tmp_path, "pedestrian.xml").status == 0
    text = (tmp_path / "draft.yml").read_text("utf-8")
    entry = text.partition(wanted)[2].partition("- id:")[0]
    open_ = [line.partition(": TODO  # TODO ")[0] for line in entry.splitlines()[1:]]
    assert open_[:3] == ["  states:", "    NotDriving", "    range_0_to_2_kmh"]
    assert open_[-1] == "    more_than_4_kmh"
    checked = run("check", "draft.yml", cwd=tmp_path)
    assert "to be decided: EDDIInputs.AV_Shuttle_Speed.states.NotDriving [K059]" in checked.err
    assert connect(tmp_path, "pedestrian.xml").err.endswith("draft.yml is up to date\n")
    mine = text.replace("NotDriving: TODO", "NotDriving: odometry.data == 0")
    (tmp_path / "draft.yml").write_text(mine, "utf-8")
    assert connect(tmp_path, "pedestrian.xml").status == 0
    kept = (tmp_path / "draft.yml").read_text("utf-8")
    assert "    NotDriving: odometry.data == 0  # TODO" in kept
    assert "    range_0_to_2_kmh: TODO  # TODO" in kept


@tabled
def test_bad_input_is_refused_and_nothing_is_written(words, code, tmp_path):
    shutil.copytree(ROOT / "examples" / "two-conserts", tmp_path, dirs_exist_ok=True)
    shutil.copy(ROOT / "examples" / "robot-models" / "Rover.yml", tmp_path)
    shutil.copy(ROOT / "examples" / "pedestrian" / "pedestrian.xml", tmp_path)
    (tmp_path / "draft.yml").write_text("Model: {type: TODO}\n", "utf-8")
    before = files_below(tmp_path)
    output = () if "-o" in words else ("-o", "draft.yml")
    failed = run("connect", *words, *output, cwd=tmp_path)
    assert (failed.status, f"[{code}]" in failed.err) == (2, True)
    assert files_below(tmp_path) == before
