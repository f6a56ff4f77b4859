"""Each diagnostic of ConSert YAML: a small file that earns it, and its exact text.

The cases stand in ``diagnostics.txt``. Sections of a file replace those of one sound ConSert,
unless the name says ``(whole file)``.
"""

import re
from functools import cache
from pathlib import Path

import hypothesis.strategies as st
import pytest
import yaml
from hypothesis import given

from eddi_scaffold.common.catalogue import area
from eddi_scaffold.common.files import Source
from eddi_scaffold.kinds.consert.consert_model import ConSertModel
from eddi_scaffold.kinds.consert.graph import path_sets
from tests.data_files import data_text
from tests.diagnosed import Cases
from tests.kinds.consert.example import monitor_of


def changed(given: str) -> str:
    """Return the sound ConSert with some sections in the place of its own."""
    parts = re.split(r"(?m)^(?=\S+:)", data_text("conserts/sound.yml") + given)
    return "".join({part.partition(":")[0]: part for part in parts if part}.values())


REPORTED = Cases(Path(__file__).with_name("diagnostics.txt"))


@pytest.mark.parametrize("name", REPORTED.inputs)
def test_text_of_the_diagnostic(name):
    text = REPORTED.inputs[name]
    reading = read(text if "(whole file)" in name else changed(text))
    REPORTED.check(name, reading.problems)


def test_every_code_has_a_case():
    printed = Path(__file__).with_name("diagnostics.txt").read_text("utf-8")
    assert all(f"[{code}]" in printed for code in area("C").diagnostics)


def test_the_sound_file_has_no_problem():
    reading = read(changed(""))
    assert reading.problems == ()
    assert [model.name for model in reading.models] == ["m"]


CASES = Path(__file__).parents[2] / "data" / "users" / "short.yml"


@cache
def cases(part):
    return {case["id"]: case for case in yaml.load(CASES.read_text(), yaml.CSafeLoader)[part]}


IDS = {
    part: [line[6:].strip("'\n") for line in text.splitlines() if line.startswith("- id: ")]
    for part, text in zip(("valid", "errors"), CASES.read_text().split("\nerrors:\n"), strict=True)
}


def read(text, name="m"):
    return ConSertModel.read_file(Source(f"{name}.yml", text.encode()), ())


def meaning(consert):
    """What a ConSert is, whatever the text of its numbers and the order over nodes."""
    values = [
        (node.kind, node.id, [numbers(d) for d in node.dimensions], node.description)
        for node in consert.nodes
        if node.kind != "gate"
    ]
    services = [(s.kind, s.id, s.functional_service_type, s.members) for s in consert.services]
    gates = [(gate.id, gate.function) for gate in consert.gates]
    marks = [(g.id, g.default, g.ranking) for g in consert.guarantees]
    return values, gates, marks, dict(consert.inputs), services


def numbers(dimension):
    covered = getattr(dimension, "covered", None)
    if hasattr(dimension, "uom"):
        covered = [(r.start.value, r.end.value, r.inclusive) for r in covered]
    more = [getattr(dimension, name, None) for name in ("subset", "uom", "value")]
    return type(dimension).__name__, dimension.type, covered, *more


@pytest.mark.parametrize("name", IDS["valid"])
def test_it_equals_the_full_form(name):
    case = cases("valid")[name]
    short, full = read(case["short"], name), read(case["full"], name)
    assert [str(p) for p in short.problems if p.level == "error"] == []
    (model,), (other,) = short.models, full.models
    assert meaning(model.data) == meaning(other.data)
    (again,) = read(model.write()[f"{name}.yml"], name).models
    assert meaning(again.data) == meaning(other.data)
    monitor, inputs = monitor_of(model)
    for verdicts in case["verdicts"]:
        monitor.execute_step(inputs(verdicts["in"]))
        states = {id_: verdict[0] for id_, verdict in monitor.verdicts().items()}
        assert states == verdicts["out"], verdicts["in"]


@pytest.mark.parametrize("name", IDS["errors"])
def test_the_first_error_stands_at_its_character(name):
    case = cases("errors")[name]
    first = next(p for p in read(case["short"]).problems if p.level == "error")
    assert (first.place.line, first.place.col) == (case["line"], case["column"]), first
    assert case["says"].lower() in f"{first.message} {first.hint}".lower()


LEAVES = "abcde"
expressions = st.recursive(
    st.sampled_from(LEAVES),
    lambda inner: st.builds(
        lambda word, parts: f"({f' {word} '.join(parts)})",
        st.sampled_from(["AND", "or"]),
        st.lists(inner, min_size=1, max_size=4),
    ),
    max_leaves=12,
)


@given(expressions)
def test_an_expression_means_what_it_says(text):
    leaves = ", ".join(f"{leaf}: bool" for leaf in LEAVES)
    reading = read(f"evidence: {{{leaves}}}\nguarantees: {{G: {text}}}\n")
    (model,) = reading.models
    sets = path_sets(model.data)["G"]
    for mask in range(2 ** len(LEAVES)):
        values = {leaf: bool(mask >> index & 1) for index, leaf in enumerate(LEAVES)}
        meant = eval(text.replace("AND", "and"), {}, values)
        assert meant == any(leaves & mask == leaves for leaves in sets)


@given(st.text(alphabet=LEAVES + '()"> .%[]{}:1\n\u00e9', max_size=40) | st.text(max_size=20))
def test_whatever_stands_there_is_read_or_refused(text):
    quoted = yaml.safe_dump(text, default_style='"', width=4096)
    reading = read(f"evidence: {{a: {quoted}}}\nguarantees: {{G: {quoted}, H: a}}\n")
    assert reading.models or any(p.place.line for p in reading.problems)


def test_deep_parentheses_are_refused():
    (problem, *_) = read(f"evidence: {{a: bool}}\nguarantees: {{G: {'(' * 60}a}}\n").problems
    assert problem.case == "C002.nested"
