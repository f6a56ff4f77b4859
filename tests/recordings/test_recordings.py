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


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("", ["1:1: I001 the file is empty: a header line with a column t is missing"]),
        ("\n e \n", ["2:1: I001 the header has no column t (time in seconds)"]),
        ("Time,e\n0,1\n", ["1:1: I001 the header has no column t (time in seconds)"]),
        ("t;e\n0;1\n", ["1:2: I001 cells are separated by semicolons, commas are expected"]),
        ("t\te\n0\t1\n", ["1:2: I001 cells are separated by tabs, commas are expected"]),
        (b"t,e\n0,\xff\n", ["2:3: I001 the file is not UTF-8 text"]),
        ("t,e,e\n", ["1:5: I001 the column 'e' is repeated"]),
        ("t,e,t\n", ["1:5: I001 the column 't' is repeated"]),
        ("t,e, Speed\n", ["1:6: I003 no input has the id 'Speed'"]),
        ("t,\n", ["1:3: I003 no input has the id ''"]),
        ("t,e\n0\n", ["2:1: I001 1 cells, but the header has 2 columns"]),
        ("t,e\n0,1,\n", ["2:1: I001 3 cells, but the header has 2 columns"]),
        (
            "t,e,n\n0, yes,1.5\n",
            [
                "2:4: I006 cannot read 'yes': expected true, false, 1, 0, or nan for unknown",
                "2:8: I006 cannot read '1.5': expected a whole number, or nan for unknown",
            ],
        ),
        (
            "t,speed\n0,1_0\n",
            ["2:3: I006 cannot read '1_0': expected a number, or nan for unknown"],
        ),
        ("t,e\n,1\n", ["2:1: I001 the time '' is not a number of seconds"]),
        ("t,e\ninf,1\n", ["2:1: I001 the time 'inf' is not a number of seconds"]),
        ("t,e\nNaN,1\n", ["2:1: I001 the time 'NaN' is not a number of seconds"]),
        ("t,e\n1e10,1\n", ["2:1: I001 the time 1e10 is out of range: at most 9e9 seconds"]),
        ("t,e\n-1e300,1\n", ["2:1: I001 the time -1e300 is out of range: at most 9e9 seconds"]),
        ("t,e\n\n", ["1:1: I001 there are no rows below the header: nothing can be played"]),
        (
            "t,e\n1,1\n1.0,1\n2,1\n0,1\n",
            [
                "3:1: I001 the time 1.0 is not after the previous one, 1",
                "5:1: I001 the time 0 is not after the previous one, 2",
            ],
        ),
        ('t,e\n0,"true\n', ["2:3: I001 this quoted cell is not closed properly"]),
        ('t,e\n0,"1"x\n', ["2:3: I001 this quoted cell is not closed properly"]),
    ],
)
def test_problems(text, wanted):
    assert found(text) == wanted


def test_many_problems_are_cut():
    _, problems = read("t,e,speed,front left,n\n" + "x,y\n" * 1000)
    assert len(problems) == MAX_PROBLEMS + 1
    assert problems[-1].message == f"... and {1000 - MAX_PROBLEMS} more problems from here on"
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
