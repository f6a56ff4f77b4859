"""Recorded inputs: what is read, what is wrong with it, and how it is played."""

import pytest

from eddi_scaffold.common.files import Source
from eddi_scaffold.kinds import ModelInput
from eddi_scaffold.monitors.input_binding import InputBinding
from eddi_scaffold.recordings.csv_recording import MAX_PROBLEMS, read_rows, recording_of
from eddi_scaffold.recordings.node import GivenInput, ReplayedNode
from eddi_scaffold.recordings.playing import ROWS, PlayedMonitor
from eddi_scaffold.recordings.playing import play as played
from runtime_lib.tests.conserts import active, monitor
from tests.data_files import tabled

TYPES = {"e": "bool", "speed": "float", "front left": "str", "n": "int"}


def read(text, types=TYPES):
    data = text if isinstance(text, bytes) else text.encode()
    return read_rows(Source("r.csv", data), types)


def found(text, types=TYPES):
    rows, problems = read(text, types)
    assert (rows is None) == any(p.level == "error" for p in problems)
    return [
        f"{p.place.line}:{p.place.col}: {p.code} {p.message}" for p in problems if p.code != "I004"
    ]


def test_cells_by_type():
    rows, problems = read(
        "\ufefft, e ,speed,front left,n\r\n"
        "0,true,1.5,near,7\r\n"
        '\r\n0.5,0,-inf,"a, ""b"" ",-3\r\n'
        '1e0,FALSE,nan,"",\r\n'
        "2,,,,\r\n"
    )
    assert problems == []
    first, second, third, fourth = [(row.t, dict(row.samples)) for row in rows]
    assert first == (0.0, {"e": True, "speed": 1.5, "front left": "near", "n": 7})
    minus = float("-inf")
    assert second == (0.5, {"e": False, "speed": minus, "front left": 'a, "b" ', "n": -3})
    assert third[1]["front left"] == ""
    assert third[1]["speed"] != third[1]["speed"]
    assert fourth == (2.0, {})


@tabled
def test_problems(text, wanted):
    assert found(text) == wanted


def test_what_is_no_text():
    assert found(b"t,e\n0,\xff\n") == ["2:3: I001 the file is not UTF-8 text"]


def test_many_problems_are_cut():
    _, problems = read("t,e,speed,front left,n\n" + "x,y\n" * 1000)
    assert len(problems) == MAX_PROBLEMS + 1
    assert problems[-1].case == "I001.more"
    assert problems[-1].place.line == MAX_PROBLEMS + 2


@pytest.mark.parametrize("text", ["nan", "NaN", "NAN"])
def test_not_a_number_is_unknown_in_every_case(text):
    types = {"e": "bool", "speed": "float", "n": "int", "list": "bool[]", "name": "str"}
    rows, problems = read(
        f"t,e,speed,n,list,name\n0,{text},{text},{text},true {text},{text}\n1,1,2,3,{text},\n",
        types,
    )
    assert problems == []
    first, second = rows
    unknown = [first.samples[name] for name in ("e", "speed", "n")]
    unknown += [first.samples["list"][1], second.samples["list"]]
    assert all(value != value for value in unknown)  # noqa: PLR0124 - NaN
    assert first.samples["list"][0] is True
    assert first.samples["name"] == text


def test_an_unknown_sample_takes_the_place_of_the_one_before():
    made = monitor(["e"], guarantees=["G"], edges=["e>G"], specs={"e": {"default": True}})
    text = "t,e\n0,\n1,nan\n2,true\n3,NaN\n4,\n5,true\n"
    wanted = [(0, ["G"]), (1, []), (2, ["G"]), (3, []), (4, []), (5, ["G"])]
    assert play(made, text, {"e": "bool"}) == wanted
    assert made.faults() == {}


def test_an_input_may_be_called_t():
    rows, problems = read("t,t\n3,true\n", {"t": "bool"})
    assert problems == []
    assert rows[0].samples == {"t": True}


def frames(made, text, types):
    """Play a recording to a monitor of which there are no files, one step per row."""
    rows, _ = read(text, types)
    bindings = [
        InputBinding(ModelInput(spec.id, types[spec.id]), spec.attribute).by_value()
        for spec in made.inputs
    ]
    topics = {spec.id: [spec.id] for spec in made.inputs}
    part = PlayedMonitor("", made, ReplayedNode(GivenInput(bindings), made), ROWS, topics, {})
    return (frame for _, frame in played([part], recording_of(rows)))


def play(made, text, types):
    return [(frame.t, active(frame.output)) for frame in frames(made, text, types)]
