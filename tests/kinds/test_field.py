"""Model files as people have them: what each of them means, or the one message that helps."""

import gzip
from pathlib import Path

import pytest

from eddi_scaffold.common.files import Source, read_source
from eddi_scaffold.common.problems import EddiError
from eddi_scaffold.monitors.loading import read_models
from tests.cli.command import run
from tests.data_files import data_file, data_text


def told(text: str, name: str) -> list[tuple[str, int | None]]:
    reading = read_models(Source(name, text.encode()))
    return [(one.code, one.place.line) for one in reading.problems if one.level == "error"]


XMLBIF, XDSL, BIF, MEF = (
    data_text(f"field/{name}") for name in ("n.xmlbif", "n.xdsl", "n.bif", "t.opsa")
)
ONE, YES = '<float value="1"/>', '<constant value="true"/>'


@pytest.mark.parametrize(
    ("text", "name", "old", "new", "wanted"),
    [
        (XMLBIF, "n.xmlbif", "</TABLE>", "</TABLE>\n<TABLE>0.6 0.4</TABLE>", ("B110", 9)),
        (XMLBIF, "n.xmlbif", "</FOR>", "</FOR>\n<FOR>A</FOR>", ("B110", 8)),
        (XMLBIF, "n.xmlbif", "<NAME>A</NAME>", "<NAME>A</NAME>\n<NAME>B</NAME>", ("B110", 5)),
        (XMLBIF, "n.xmlbif", "<NAME>N</NAME>", "<NAME>N</NAME>\n<NAME>B</NAME>", ("B110", 3)),
        (XMLBIF, "n.xmlbif", "</NETWORK>", "</NETWORK>\n<NETWORK/>", ("B110", 10)),
        (XDSL, "n.xdsl", "</parents>", "</parents>\n<parents>B</parents>", ("B110", 5)),
        (BIF, "n.bif", "table", "default 0.5, 0.5;\ntable", ("B201", 5)),
        (BIF, "n.bif", "0.9;", "0.9;\ndefault 0.5, 0.5;", ("B201", 5)),
        (BIF, "n.bif", "}; }", "};\ntype discrete [2] { a, b }; }", ("B201", 3)),
        (MEF, "t.opsa", "<float", f"<neg>{ONE * 2}</neg><float", ("R017", 2)),
        (MEF, "t.opsa", '<float value="0.1"/>', f"<neg>{ONE * 2}</neg>", ("R002", 2)),
        (MEF.replace("basic", "house"), "t.opsa", '<float value="0.1"/>', YES * 2, ("R017", 2)),
    ],
)
def test_no_second_value_is_dropped(
    text: str, name: str, old: str, new: str, wanted: tuple[str, int]
) -> None:
    assert told(text, name) == [] or "house" in text
    assert text.count(old) == 1
    assert told(text.replace(old, new), name) == [wanted]


def eddi(failure: str, event: str = "") -> str:
    text = data_text("field/pump.xml")
    return text.replace("⟦FAILURE⟧", failure).replace("⟦EVENT⟧", event)


UNIT = '<keyValueMaps key="unit"><values value="1/h"/>'
WEIBULL = '<failureProbDistribution type="Weibull"><parameters name="scale" value="5"/>'


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (eddi(f'failureRate="1e-4">{UNIT}\n<values value="1/s"/></keyValueMaps>'), 3),
        (eddi(f'failureRate="1e-4">{UNIT}</keyValueMaps>\n{UNIT}</keyValueMaps>'), 3),
        (eddi(f'>{WEIBULL}\n<parameters name="eta" value="7"/></failureProbDistribution>'), 3),
        (eddi('failureRate="1e-4">', " //@failures.2"), 4),
    ],
)
def test_no_second_value_of_an_eddi_is_dropped(text: str, line: int) -> None:
    assert ("X011", line) in told(text, "m.xml")


def test_a_rate_beside_a_distribution_is_told() -> None:
    given = '<failureProbDistribution type="Fit"><parameters name="Value" value="1"/>'
    for rate, wanted in (("1e-4", ["X014"]), ("0.0", [])):
        text = eddi(f'failureRate="{rate}">{given}</failureProbDistribution>')
        reading = read_models(Source("m.xml", text.encode()))
        assert [one.code for one in reading.problems] == wanted


def test_intervals_of_bif() -> None:
    text = (
        "variable A { type discrete [4] { (-Inf, 0], (0,1), [1,2), low }; }\n"
        "variable B { type discrete [2] { 0, 1 }; }\n"
        "probability (A) { table 0.25, 0.25, 0.25, 0.25; }\nprobability (B | A) {\n"
        "((-Inf,0]) 0.1, 0.9; ((0, 1)) 0.2, 0.8; ([1,2)) 0.3, 0.7; (low) 0.4, 0.6; }\n"
        "variable C { type discrete [2] { y, n }; } probability (C | A B) {\n"
        "default 0.5, 0.5; ((0,1), 0) 0.1, 0.9; }"
    )
    (model,) = read_models(Source("n.bif", text.encode())).models
    assert model.data.node("A").states == ("(-Inf,0]", "(0,1)", "[1,2)", "low")
    assert model.data.node("B").table == (0.1, 0.9, 0.2, 0.8, 0.3, 0.7, 0.4, 0.6)
    assert model.data.node("C").table[4:6] == (0.1, 0.9)


@pytest.mark.parametrize(
    ("numbers", "code"),
    [
        ("0.3333, 0.3333, 0.3333", "B113"),
        ("3.333e-01, 3.333e-01, 3.333e-01", "B113"),
        ("0.4, -1.2e-7, 0.6", "B113"),
        ("1.00000012, -1.2e-7, 0", "B113"),
        ("0.33, 0.33, 0.33", "B113"),
        ("0.3333, 0.3334, 0.3331", "B113"),
        ("0.4, -1.2e-2, 0.612", "B112"),
        ("0e99999, 1e-99999999999999999999, 0.5", "B113"),
    ],
)
def test_what_rounding_explains_is_read(numbers: str, code: str) -> None:
    text = data_file("field/row-rounding/tank.bif").read_text()
    reading = read_models(Source("n.bif", text.replace("0.3333, 0.3333, 0.3333", numbers).encode()))
    assert [one.code for one in reading.problems] == [code]


OTHERS = {
    "x.xdsl": b"version https://git-lfs.github.com/spec/v1\noid sha256:1\n",
    "x.xdsl.gz": gzip.compress(b"<smile/>"),
    "x.zip": b"PK\x03\x04abc",
    "x.dsc": b'belief network "ab"\nnode A {}\n',
    "x.pgmx": b'<?xml version="1.0"?>\n<ProbModelXML formatVersion="1.0"/>',
    "x.xbn": b"<?xml version='1.0'?>\n<ANALYSISNOTEBOOK/>",
    "x.xml": b'<?xml version="1.0"?>\n<BIF VERSION="0.5"><NETWORK/></BIF>',
    "x.dne": b"\xef\xbb\xbfbnet Pump {};",
    "x.net": b'% by Hugin\nnet { }\nnode A { states = ("y" "n"); }\n',
    "y.net": b"class Pump {\n}\n",
}
NAMES = (
    *("Git LFS", "gzip", "zip", "MSBN", "OpenMarkov", "MSBN", "XMLBIF 0.4 or 0.5", "Netica"),
    *("Hugin", "Hugin"),
)


@pytest.mark.parametrize(("file", "name"), list(zip(OTHERS, NAMES, strict=True)))
def test_other_formats_are_named(file: str, name: str, tmp_path: Path) -> None:
    (tmp_path / file).write_bytes(OTHERS[file])
    with pytest.raises(EddiError) as found:
        read_source(tmp_path / file)
    (problem,) = found.value.problems
    assert problem.code == "F003"
    assert name in problem.message
    assert problem.hint


def test_a_reference_that_lies_in_git_lfs(tmp_path: Path) -> None:
    (tmp_path / "time.csv").write_bytes(OTHERS["x.xdsl"])
    config = data_file("field/reference-csv/time.yml").read_bytes()
    (problem,) = read_models(read_at(tmp_path, config)).problems
    assert (problem.code, problem.hint) == ("L004", "run `git lfs pull`")


def read_at(folder: Path, config: bytes) -> Source:
    (folder / "time.yml").write_bytes(config)
    return read_source(folder / "time.yml")


def test_common_causes_are_told_before_what_they_leave_undefined() -> None:
    text = data_file("field/ccf-members/pumps.xml").read_text()
    assert told(text, "pumps.xml") == [("R017", 5)]
    assert told(text.replace("define-CCF-group", "define-x"), "pumps.xml") == [("R001", 3)]


def test_the_quote_that_is_not_closed() -> None:
    text = data_file("field/wrong-xml-error/drone.xml").read_text()
    assert told(text, "drone.xml") == [("X001", 3)]


ROOTS = [
    (data_file("field/root-fault-tree/pump.xml").read_text(), "reliability"),
    (data_text("field/chain.xml"), "reliability"),
    (data_text("field/consert.xml"), "consert"),
]


@pytest.mark.parametrize(("text", "kind"), ROOTS)
def test_a_model_may_be_the_root(text: str, kind: str, tmp_path: Path) -> None:
    reading = read_models(Source("m.xml", text.encode()))
    assert [(one.kind, one.place.path) for one in reading.models] == [(kind, "/")]
    assert "X006" not in {one.code for one in reading.problems}
    (tmp_path / "m.xml").write_text(text)
    assert run("show", "m.xml", cwd=tmp_path).status == 0
