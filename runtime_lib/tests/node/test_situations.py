"""What a person reads when a claim is lost: each situation of the oracle, log and diagnostics."""

import math
from types import SimpleNamespace

import pytest
import yaml
from eddi_runtime.node.claim_log import ClaimLog
from eddi_runtime.node.report import GraphFact, Reason, claim_text
from eddi_runtime.node.topics import other_type
from eddi_runtime.why import TEXTS, Cause, ClaimWhy, read_why, seconds, why_tree

from tests.data_files import data_file

SITUATIONS = yaml.safe_load(data_file("users/situations.yml").read_text("utf-8"))["situations"]
VALUES = {"false": 0, "unknown": 1, "true": 2}


def cause_of(row):
    """Return a cause as a monitor and its node make it of these facts."""
    facts, state, limit = row["facts"], row["state"], row["limit"]
    text, detail, reason = TEXTS.get(state, ""), row["detail"], None
    if "exception" in facts:
        text = "{method} raised {exception} in {file} line {line}".format(**facts)
    if "size" in facts:
        text = "window has {filled} of {size} samples".format(**facts)
    if "clock_back" in facts:
        text += f", the clock went back {seconds(facts['clock_back'])}"
    if "robot" in facts:
        text = f"robot {facts['robot']} silent {{age}}, lease {{limit}}"
    if "values" in facts:
        detail = ", ".join(f"{name} {value}" for name, value in facts["values"].items())
    if "registered" in facts:
        reason = Reason("", detail="its publisher is there")
    if "nearest_name" in facts:
        near = f"nobody publishes it, the nearest name is {facts['nearest_name']}"
        reason = Reason("", detail=near)
    if state == "gone":
        state, text, reason = "silent", TEXTS["silent"], Reason("gone")
    if state == "type":
        state, text, reason = "never", TEXTS["never"], other_type(facts["sent"], facts["needed"])
    age, limit = (math.nan if of is None else of for of in (row["age"], facts.get("grace", limit)))
    cause = Cause(
        tuple(row["path"]), state, text, row["topic"], (), row["since"], age, limit, detail
    )
    graph = GraphFact(reasons={row["topic"]: reason} if reason else {})
    made = graph.explained(cause)
    assert made.state == row["state"]
    return made


def rows_of(causes, value, claim):
    return {claim: ClaimWhy(claim, VALUES[value], tuple(map(cause_of, causes)))}


@pytest.mark.parametrize("case", SITUATIONS, ids=lambda case: case["id"])
def test_the_line_of_the_log_and_the_value_of_the_diagnostics(case):
    claim, log = case["claim"], ClaimLog()
    now = rows_of(case["causes"], case["value"], claim)
    word = (case["log"] or {"text": ""})["text"].partition(" ")[0]
    holds, at, waiting = rows_of([], "true", claim), 100.0, word == ""
    if word in ("lost", "still", "again"):
        log.note(holds, at, waiting)
    if word == "still":
        log.note({claim: ClaimWhy(claim, 1, (Cause(("PathClear",), "untold", ""),))}, at, waiting)
        assert [*log.lines(now, at + 0.5)]
    if word == "missing":
        log.note(now, at, waiting=True)
        assert not log.waits
    if word == "again":
        log.note(rows_of(case["before"], "unknown", claim), at, waiting)
        assert [*log.lines(rows_of(case["before"], "unknown", claim), at + 0.4)]
    then = at + case.get("lost_for", 2.0)
    log.note(now, then, waiting)
    lines = [{"level": level.upper(), "text": text} for level, text in log.lines(now, then + 0.3)]
    assert lines == ([case["log"]] if case["log"] else [])
    assert claim_text(now[claim]) == case["diagnostics"]
    assert now[claim].sentence == case.get("sentence", "")
    assert read_why(message(why_tree("w", now)))[claim].sentence == now[claim].sentence


def message(value):
    if isinstance(value, tuple):
        return SimpleNamespace(**{name: message(one) for name, one in value[1].items()})
    return [message(one) for one in value] if isinstance(value, list) else value
