"""The block SimulatorOutputs is replaced as text: every other byte stays."""

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import EddiError
from eddi_scaffold.config.topic_block import (
    ConfigText,
    read_block,
    rewritten,
)
from eddi_scaffold.mros.topics import TopicEntry
from tests.data_files import tabled

SCAN = TopicEntry("scan", "sensor_msgs.LaserScan", "/scan")
NEW = """SimulatorOutputs:
  - id: scan
    type: sensor_msgs.LaserScan
    topic: /scan
"""


def document(text: str) -> ConfigText:
    return read_block(Source("c.yml", text.encode()))


def written(text: str, *entries: TopicEntry) -> tuple[str, list[tuple[str, int | None]]]:
    new, problems = rewritten(document(text), entries)
    return new, [(problem.code, problem.place.line) for problem in problems]


@tabled
def test_every_legal_form_of_the_old_block(old: str) -> None:
    before = "# the robot\nModel: {id: A, type: ConSert}  # fixed\n\n"
    after = "\n# what the model needs\nEDDIInputs:\n  - id: x # here\n"
    assert written(before + old + after, SCAN) == (before + NEW + after, [])


@tabled
def test_where_a_block_goes_that_is_not_there(text: str, expected: str) -> None:
    assert written(text, SCAN) == (expected.replace("NEW", NEW), [])


def test_other_keys_stay_with_their_topic() -> None:
    old = (
        "SimulatorOutputs:\n- id: a\n  max_age: 0.5\n  topic: /scan\n"
        "  note:\n    - x\n    - y\n- id: b\n  topic: /b\n"
    )
    text, problems = written(old, SCAN)
    assert text == NEW + "    max_age: 0.5\n    note:\n      - x\n      - y\n"
    assert problems == [("M026", 8)]


def test_an_entry_that_an_input_needs_stays() -> None:
    inputs = (
        "EDDIInputs:\n  - id: x\n    requires: [other, scan]\n  - id: y\n    requires: [gone]\n"
    )
    old = (
        "SimulatorOutputs:\n  -  id: other\n     type: eddi_messages.ConSertOutput\n"
        "     topic: /b\n"
    )
    text, problems = written(old + inputs, SCAN)
    kept = "  - id: other\n    type: eddi_messages.ConSertOutput\n    topic: /b\n"
    assert text == NEW + kept + inputs
    assert problems == [("M026", 2), ("M023", 9)]
    assert written(text, SCAN)[0] == text


def test_comments_stay_with_their_entries() -> None:
    old = (
        "SimulatorOutputs: # one\r\n# two\r\n-  topic: /scan   # three\r\n   # four\r\n"
        "   id: scan\r\n\r\n   # five\r\n   type: sensor_msgs.LaserScan # six\r\n# seven\r\n"
    )
    text, problems = written(old, SCAN)
    assert problems == []
    assert text == (
        "SimulatorOutputs: # one\r\n  # two\r\n  - topic: /scan   # three\r\n    # four\r\n"
        "    id: scan\r\n\r\n    # five\r\n    type: sensor_msgs.LaserScan # six\r\n# seven\r\n"
    )
    assert written(text, SCAN) == (text, [])


def test_comments_of_an_entry_that_changes_stand_above_it() -> None:
    old = "SimulatorOutputs:\n  # one\n  - id: a#b\n    # two\n    topic: /scan # three\n# four\n"
    text, problems = written(old, SCAN)
    head, _, entry = NEW.partition("\n")
    assert text == f"{head}\n  # one\n  # two\n  # three\n{entry}# four\n"
    assert problems == []


@tabled
def test_what_cannot_be_changed(text: str, code: str, line: int, words: str) -> None:
    with pytest.raises(EddiError) as refused:
        document(text)
    (problem,) = refused.value.problems
    assert (problem.code, problem.place.line) == (code, line)
    assert words in problem.message


texts = st.text(st.characters(codec="utf-8", exclude_categories=("C",)), min_size=1, max_size=8)
entries = st.lists(st.builds(TopicEntry, texts, texts, texts), max_size=4)


@given(entries)
def test_what_is_written_is_read_back(entries: list[TopicEntry]) -> None:
    text, _ = rewritten(ConfigText("c.yml", ""), entries)
    result = yaml.safe_load(text)["SimulatorOutputs"]
    assert result == [{"id": e.id, "type": e.type, "topic": e.topic} for e in entries]


parts = st.sampled_from(
    [
        "# a comment\n",
        "\n",
        "Model:\n  id: A # x\n\n",
        "EDDIInputs:\n- id: ü\n  requires: scan\n",
        "Package: {version: 1.2.3}\n",
        "EDDIOutputs:\n  - id: |\n      text\n\n  # end\n",
    ]
)
blocks = st.sampled_from(
    ["", "SimulatorOutputs: []\n", "SimulatorOutputs:\n- id: s\n  topic: /scan\n  max_age: 1\n"]
)


@given(st.lists(parts, unique=True), blocks, st.lists(parts, unique=True), entries)
def test_all_else_stays_and_a_second_run_changes_nothing(
    before: list[str], block: str, after: list[str], entries: list[TopicEntry]
) -> None:
    rest = [part for part in after if part not in before]
    old = document("".join([*before, block, *rest]))
    unique = list({entry.topic: entry for entry in entries}.values())
    text, _ = rewritten(old, unique)
    assert text.startswith(old.text[: old.start])
    assert text.endswith(old.text[old.end :])
    assert rewritten(document(text), unique)[0] == text
