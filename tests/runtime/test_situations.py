"""The sentences of the oracle's situations, from facts that no recording can show."""

from pathlib import Path
from types import SimpleNamespace

import pytest
import yaml
from eddi_runtime import why
from eddi_runtime.why import NAN, Cause

ORACLE = Path(__file__).parents[1] / "data" / "oracles" / "users" / "situations.yml"
SITUATIONS = yaml.load(ORACLE.read_text("utf-8"), yaml.CSafeLoader)["situations"]
VALUES = {"false": why.FALSE, "unknown": why.UNKNOWN, "true": why.TRUE}


def text_of(cause, facts):
    """Return the text of the facts as a monitor or a node writes it, and what is in brackets."""
    text, detail = why.TEXTS.get(cause["state"], ""), cause["detail"]
    if "registered" in facts:
        detail = "its publisher is there"
    if "nearest_name" in facts:
        detail = f"nobody publishes it, the nearest name is {facts['nearest_name']}"
    if "sent" in facts:
        text = f"{facts['sent']} comes, {facts['needed']} is needed"
    if "filled" in facts:
        text = f"window has {facts['filled']} of {facts['size']} samples"
    if "clock_back" in facts:
        text += f", the clock went back {why.seconds(facts['clock_back'])}"
    if "exception" in facts:
        text = "{method} raised {exception} in {file} line {line}".format(**facts)
    if "robot" in facts:
        text = f"robot {facts['robot']} silent {{age}}, lease {{limit}}"
    if "values" in facts:
        detail = ", ".join(f"{name} {value}" for name, value in facts["values"].items())
    return text, detail


def cause_of(cause):
    facts = cause["facts"]
    text, detail = text_of(cause, facts)
    limit = facts.get("grace", cause["limit"])
    return Cause(
        tuple(cause["path"]),
        cause["state"],
        text,
        cause["topic"],
        ("w",),
        cause["since"],
        NAN if cause["age"] is None else cause["age"],
        NAN if limit is None else limit,
        detail,
    )


@pytest.mark.parametrize("case", SITUATIONS, ids=lambda case: case["id"])
def test_sentence_of_a_situation(case):
    causes = [cause_of(one) for one in case["causes"]]
    claim = why.claim_why("w", case["claim"], VALUES[case["value"]], causes)
    assert claim.sentence == case.get("sentence", "")
    sent = read(why.why_tree("w", {claim.id: claim}))
    assert sent[claim.id].sentence == claim.sentence
    for before in case.get("before", ()):
        assert f"({cause_of(before).chain})" in case["log"]["text"]


def read(tree):
    return why.read_why(message(tree))


def message(value):
    if isinstance(value, tuple):
        return SimpleNamespace(**{name: message(one) for name, one in value[1].items()})
    return [message(one) for one in value] if isinstance(value, list) else value
