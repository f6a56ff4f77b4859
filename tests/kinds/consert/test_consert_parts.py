"""Export, options, claims, inputs, outline and messages of one ConSert."""

import ast
import hashlib
import keyword

import pytest
from eddi_runtime import ModelError
from hypothesis import given
from hypothesis import strategies as st

from eddi_scaffold.common import identifiers
from eddi_scaffold.common.claims import Claim
from eddi_scaffold.common.files import Source
from eddi_scaffold.common.identifiers import RESERVED
from eddi_scaffold.kinds import Options
from eddi_scaffold.kinds.consert import MESSAGES, published_class
from eddi_scaffold.kinds.consert.consert import BinaryDimension, Bound, ConSert, Guarantee, Range
from eddi_scaffold.kinds.consert.consert_model import ConSertModel
from eddi_scaffold.kinds.consert.options import ConSertOptions, with_default_guarantees
from eddi_scaffold.kinds.consert.ranges import is_empty
from runtime_lib.tests.conserts import categorical, consert, give, numeric
from tests.kinds.consert.example import ROVER, read
from tests.program.formatting import HOSTILE, assert_plain_data


def test_the_reserved_words_hold_those_of_this_python():
    assert set(keyword.kwlist) | set(keyword.softkwlist) <= RESERVED


@pytest.mark.parametrize(
    ("id_", "attribute", "published"),
    [
        ("Lidar_Ok", "Lidar_Ok", "LidarOk"),
        ("2nd lidar", "_2nd_lidar", "2NdLidar"),
        ("class", "class_", "Class"),
        ("true", "true", "True_"),
        ("update", "update_", "Update"),
        ("process_x", "process_x_", "ProcessX"),
        ("unknown", "unknown", "Unknown_"),
        ("a-b", "a_b", "AB"),
    ],
)
def test_names_of_awkward_ids(id_, attribute, published):
    assert identifiers.attribute(id_) == attribute
    assert published_class(id_) == published


@given(st.text(min_size=1))
def test_derived_names_stand_in_code(id_):
    name = identifiers.attribute(id_)
    ast.parse(f"self.{name} = 1\ndef process_{name}(self): pass")


def test_a_range_without_a_double_is_empty():
    def covered(start):
        return Range(Bound(start, float(start)), Bound("5", 5.0), True, start_inclusive=False)

    assert not is_empty(covered("4.999999999999999"))
    assert is_empty(covered("4.99999999999999999999"))


@pytest.mark.parametrize(
    ("values", "chosen"),
    [
        ({}, ConSertOptions()),
        ({"guarantee_ids": "class"}, ConSertOptions("class")),
        ({"debounce": 3}, ConSertOptions("source", "debounce", 3)),
        ({"debounce": 1}, ConSertOptions()),
        ({"filter": {"kind": "none"}}, ConSertOptions()),
        ({"filter": {"kind": "debounce"}}, ConSertOptions()),
        ({"filter": {"kind": "majority", "window": 5}}, ConSertOptions("source", "majority", 5)),
    ],
)
def test_what_a_configuration_chooses(values, chosen):
    configured, problems = read(ROVER).configure(Options(values=values))
    assert (configured.options, problems) == (chosen, [])


@pytest.mark.parametrize(
    ("values", "code"),
    [
        ({"guarantee_ids": "both"}, "K003"),
        ({"debounce": 0}, "K028"),
        ({"debounce": True}, "K028"),
        ({"debounce": 10**9}, "K028"),
        ({"filter": "majority"}, "K003"),
        ({"filter": {}}, "K028"),
        ({"filter": {"kind": "median"}}, "K028"),
        ({"filter": {"kind": ["debounce"]}}, "K028"),
        ({"filter": {"kind": "debounce", "regain_after": 0}}, "K028"),
        ({"filter": {"kind": "debounce", "regain_after": True}}, "K028"),
        ({"filter": {"kind": "majority", "window": 2.0}}, "K028"),
        ({"filter": {"kind": "majority", "window": 10**9}}, "K028"),
        ({"filter": {"kind": "none"}, "debounce": 2}, "K003"),
    ],
)
def test_what_no_configuration_may_choose(values, code):
    configured, problems = read(ROVER).configure(Options(values=values))
    assert (configured, [problem.code for problem in problems]) == (None, [code])


def test_a_majority_holds_for_half_of_its_window():
    values = {"filter": {"kind": "majority", "window": 5}, "guarantee_ids": "class"}
    model, _ = read(ROVER).configure(Options(values=values))
    inputs = model.inputs()
    fast, slow, default = model.claims(inputs, 10.0)
    leaves = frozenset({"Distance", "MapKnown", "Lidar"})
    assert fast == Claim("FastDrive", leaves, 0.2, gates=("Both",))
    assert (slow.rests_on, default.rests_on) == (frozenset({"Lidar"}), frozenset())
    (accepted,) = model.acceptances(inputs, 10.0)
    assert (accepted.key, accepted.seconds) == ("filter: majority", 0.2)


def test_messages_keep_the_md5_of_the_packages_in_the_wild():
    guarantee = hashlib.md5(MESSAGES["Guarantee"].strip().encode()).hexdigest()
    assert guarantee == "b3a7e576b5781883d831dab64cec7ef8"
    output = MESSAGES["ConSertOutput"].strip().replace("Guarantee[]", guarantee)
    assert hashlib.md5(output.encode()).hexdigest() == "c306fb7ec8f6dbe6af438338cb2d6720"


def test_marks_of_default_guarantees():
    text = ROVER.replace("    default: true\n", "")
    source = Source("Rover.yml", text.encode())
    assert {p.code for p in ConSertModel.read_file(source, ()).problems} == {"C011"}
    for mark in ("StandStill", "Rover/StandStill"):
        assert read(text, marks=(mark,)).data == read(ROVER).data
    (problem,) = ConSertModel.read_file(source, ("Standstill", "StandStill")).problems
    assert problem.message == "--default-guarantee Standstill: there is no guarantee 'Standstill'"
    assert (problem.code, problem.hint) == ("C008", "did you mean 'StandStill'?")


def test_a_deep_chain_is_cut_in_the_outline():
    gates = "".join(f"  - {{id: g{n}, function: Or}}\n" for n in range(50))
    edges = "".join(f"  - {{from: g{n + 1}, to: g{n}}}\n" for n in range(49))
    text = ROVER.replace("gates:\n", f"gates:\n{gates}")
    head = "tree_propagations:\n"
    text = text.replace(
        head, f"{head}{edges}  - {{from: g0, to: SlowDrive}}\n  - {{from: Lidar, to: g49}}\n"
    )
    model = read(text)
    assert "  " * 30 + "Or g29 ..." in model.outline()
    assert "`g3 AND Lidar`" in "".join(model.readme())


def test_a_readme_says_what_a_guarantee_needs():
    text = """
evidence: {Lidar: bool, Radar: bool, Charge: 20 .. 100 %, Rain: bool, Fog: bool}
guarantees:
  Drive: (Lidar OR (Radar AND Rain AND Fog)) AND Charge
  Speed: {when: Lidar, gives: 0 .. 2 m/s}
  Wait: always
"""
    assert read(text).readme() == [
        "| guarantee | type | active while |",
        "|---|---|---|",
        "| `Drive` | Drive | `(Lidar OR (Radar AND Rain AND Fog)) AND Charge` |",
        "| `Speed` | Speed in [0, 2] m/s | `Lidar` |",
        "| `Wait` | Wait | always |",
    ]


def test_a_mark_is_of_one_guarantee_though_names_have_slashes():
    dimension = (BinaryDimension("T"),)

    def consert(name, id_):
        return ConSert(name, (Guarantee(id_, dimension),), (), (), (), (), (), ())

    marked, problems = with_default_guarantees(
        [consert("a", "b/c"), consert("a/b", "c")], ["c"], "m"
    )
    assert [node.default for one in marked for node in one.guarantees] == [False, True]
    _, problems = with_default_guarantees(marked, ["a/b/c"], "m")
    assert [problem.case for problem in problems] == ["C008.several"]


def large(**settings):
    ids = [f"input_{k}" for k in range(40)]
    gates = [f"gate{k}{'&|'[k % 2]}" for k in range(30)]
    edges = [f"{one}>gate{k % 30}" for k, one in enumerate(ids)]
    edges += [f"gate{k}>gate{k + 1}" for k in range(29)]
    evidence = [
        (one, [numeric("[0, 5)", "[7, inf]"), categorical("low", "mid"), numeric("[1, 2]")][k % 3])
        for k, one in enumerate(ids)
    ]
    guarantees = [{"id": "G", "ranking": 1}, "H", {"id": "D", "default": True}]
    edges += ["gate29>G", "gate7>H", "gate8>H"]
    return consert(evidence, [], gates, guarantees, edges, [("S", ["G", "H"])], **settings)


def hostile():
    evidence = [(one, categorical(*HOSTILE)) for one in HOSTILE]
    edges = [(one, "G") for one in HOSTILE]
    specs = {one: {"attribute": f"value {k}"} for k, one in enumerate(HOSTILE)}
    paths = {one: HOSTILE[-k] for k, one in enumerate(HOSTILE)}
    name = '"""\nimport os \\'
    return consert(evidence, (), (), ["G"], edges, specs=specs, paths=paths, name=name)


@pytest.mark.parametrize("made", [large(), large(filtered=("debounce", 3)), hostile()])
def test_the_formatter_changes_nothing_and_nothing_of_a_model_becomes_code(made):
    assert_plain_data(made.text())


def test_a_hostile_model_works():
    monitor = hostile().monitor()
    good = {f"value {k}": one for k, one in enumerate(HOSTILE)}
    assert monitor.execute_step(give(**good)) == [{"id": "G", "active": True}]
    bad = dict(good, **{"value 3": "else"})
    assert monitor.execute_step(give(**bad)) == [{"id": "G", "active": False}]


def test_a_changed_file_is_refused(tmp_path, monkeypatch):
    text = large().text()
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "compiled_whole.py").write_text(text)
    __import__("compiled_whole")
    for number, changed in enumerate(
        (text[: text.rindex("        return [")], text.replace("== 2", "== 1", 1))
    ):
        (tmp_path / f"compiled_{number}.py").write_text(changed)
        with pytest.raises(ModelError, match=r"the file was changed .*eddi-scaffold upgrade"):
            __import__(f"compiled_{number}")


def test_another_format_of_a_part_is_refused():
    text = large().text().replace("consert: 3}", "consert: 7}")
    with pytest.raises(ModelError, match=r"format 7 of eddi_runtime\.consert, but .* runs 3: run"):
        exec(text, {"__file__": "compiled.py"})
