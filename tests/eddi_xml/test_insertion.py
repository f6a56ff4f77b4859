"""A map that is written into the text of an EDDI: it is read again, and all else is as it was."""

from pathlib import Path

import pytest
from lxml import etree

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import EddiError
from eddi_scaffold.eddi_xml.insertion import with_map
from eddi_scaffold.eddi_xml.parsing import select
from eddi_scaffold.monitors.exports import written_into
from eddi_scaffold.monitors.loading import read_models
from tests.cli.command import ROOT, run
from tests.eddi_xml.eddi_texts import parsed

KEY = "eddi.events"
VALUES = [("model", "w"), ("EVENT", 'a (EVIDENCE) := x["<&>"] > 1 \t; \u00e9')]
MODELS = Path(__file__).parent / "models"
FILES = [
    ROOT / "examples/two-conserts/two_conserts.xml",
    ROOT / "examples/drone/drone.xml",
    *sorted(MODELS.glob("*.xml")),
]
ODD = """<?xml version='1.0' encoding='ASCII'?>
<!-- <a> is no element, nor is </a> -->
<r><![CDATA[<b>]]><c  x='>'   /><?d <e> ?>
\t<c y="/>">text</c><c/>
</r>
"""


def canonical(data: bytes) -> tuple[str, list[tuple[str, str]]]:
    """Return a document without the map, whose values are returned as well, and its layout."""
    document, _ = parsed(data)
    tree = document.document
    found = []
    for one in select(tree, f'//*[local-name()="keyValueMaps"][@key="{KEY}"]'):
        values = [(str(v.get("tag")), str(v.get("value"))) for v in one]
        if values[0] == VALUES[0]:
            found += values
            before, around = one.getprevious(), one.getparent()
            if before is not None:
                before.tail = (before.tail or "") + (one.tail or "")
            else:
                around.text = (around.text or "") + (one.tail or "")
            around.remove(one)
    for one in tree.iter():
        one.text = (one.text or "").strip()
        one.tail = (one.tail or "").strip()
    return etree.tostring(tree, encoding="unicode"), found


def written(data: bytes, number: int) -> bytes:
    document, _ = parsed(data)
    at = list(document.document.iter())[number]
    return with_map(data, document, at, KEY, VALUES)


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.name)
def test_at_every_element(file: Path) -> None:
    sound = file.read_bytes()
    for data in (sound, sound.replace(b"\n", b"\r\n"), b"\xef\xbb\xbf" + sound):
        for number in range(0, data.count(b"<") // 2, 3):
            try:
                new = written(data, number)
            except IndexError:
                break
            assert canonical(new) == (canonical(data)[0], VALUES)
            start = next(k for k, (a, b) in enumerate(zip(data, new, strict=False)) if a != b)
            assert new.startswith(data[:start])
            assert new[-20:] == data[-20:]


@pytest.mark.parametrize("number", range(4))
def test_odd_markup(number: int) -> None:
    data = ODD.encode("ascii")
    new = written(data, number)
    assert canonical(new) == (canonical(data)[0], VALUES)
    assert b"&#233;" in new
    assert written(new, number) == new, "the map of the same model is replaced"


def test_an_encoding_that_is_no_longer_the_same_is_refused() -> None:
    data = ODD.replace("ASCII", "UTF-16").encode("utf-16-be")
    with pytest.raises(EddiError, match="is not changed"):
        written(b"\xfe\xff" + data, 0)


def test_events_go_into_an_eddi_and_come_back(tmp_path: Path) -> None:
    text = (
        "// of the winding\nENUM Mode { AUTO, MANUAL }\nVAR x : NUMBER UNIT degC TIMEOUT 1s\n"
        "CONST most = 80 degC\n// two of them\nEVENT hot (HAZARD) := ONCE(x > most, 2s)\n"
    )
    (tmp_path / "w.events").write_text(text, "utf-8")
    sound = (MODELS / "landing.xml").read_bytes()
    (tmp_path / "m.xml").write_bytes(sound)
    at = "//@odeProductPackages.1/@hazards.0"
    for _ in range(2):
        done = run("export", "w.events", "--into", "m.xml", "--at", at, cwd=tmp_path)
        assert done.status == 0, done.err
    assert run("export", "m.xml", "--name", "w", "-o", "out", cwd=tmp_path).status == 0
    assert (tmp_path / "out" / "w.events").read_text("utf-8") == text
    at = "//@odeProductPackages.0/@systems.0"
    words = ("export", "m.xml", "--name", "motor_watch")
    assert run(*words, "-o", "out", cwd=tmp_path).status == 0
    sound = (tmp_path / "m.xml").read_bytes()
    words = ("export", "out/motor_watch.events", "--into", "m.xml", "--at", at)
    assert run(*words, cwd=tmp_path).status == 0
    assert (tmp_path / "m.xml").read_bytes() == sound, "the frequency is in no file of events"
    assert len(read_models(Source("m.xml", (tmp_path / "m.xml").read_bytes())).models) == 3


def test_a_name_that_is_taken_writes_nothing(tmp_path: Path) -> None:
    sound = (MODELS / "landing.xml").read_bytes()
    events = Source("motor_watch.events", b"VAR x : NUMBER TIMEOUT 1s\nEVENT a (HAZARD) := x > 1\n")
    with pytest.raises(EddiError, match="there are two models 'motor_watch'"):
        written_into(Source("m.xml", sound), "/", read_models(events).models)
