"""Plots: what is drawn where, that any text is safe, that the bytes are the same."""

from dataclasses import replace
from xml.etree import ElementTree as ET

from hypothesis import given
from hypothesis import strategies as st

from eddi_scaffold.diagrams.plot import Track, plot, tracks_of

SVG = "{http://www.w3.org/2000/svg}"


def track(*values: object, name: str = "G0") -> Track:
    return tracks_of("outputs", [(float(t), {name: v}) for t, v in enumerate(values)])[0]


def test_what_is_true_may_be_bad_and_is_not_green() -> None:
    (band, *_) = [
        rect.attrib["fill"]
        for rect in ET.fromstring(plot("SafeML", [track(True, name="odd_violation")])).iter()
        if rect.tag == f"{SVG}rect" and len(rect)
    ]
    red, green, blue = (int(band[at : at + 2], 16) for at in (1, 3, 5))
    assert blue > green > red


def reasons(root: ET.Element) -> list[ET.Element]:
    return [text for text in root.iter(f"{SVG}text") if text.attrib.get("class") == "reason"]


def test_a_reason_is_below_its_bar_and_ends_before_the_next_one() -> None:
    chain = "nearest <- /lidar/<nearest>: nothing for 0.4 s, limit 0.3 s"
    values = [True, None, None, None, None, None, None, True]
    told = replace(track(*values), reasons=("", *[chain] * 6, ""))
    root = ET.fromstring(plot("x", [told, replace(track(*values), reasons=("", *"abcdef", ""))]))
    bars = [bar for bar in root.iter(f"{SVG}rect") if len(bar)]
    assert [bar[0].text for bar in bars[:2]] == [
        "holds: 0 s to 1 s",
        f"unknown: 1 s to 7 s, {chain}",
    ]
    assert len(bars) == 3 + 8
    shown, _ = reasons(root)
    assert (shown[0].text, shown[0].tail) == (chain, chain)
    assert float(shown.attrib["y"]) > float(bars[1].attrib["y"]) + float(bars[1].attrib["height"])

    told = replace(track(*values, *values), reasons=("", *"ab", *[chain] * 4, "") * 2)
    first, second = reasons(ET.fromstring(plot("x", [told])))
    assert str(first[0].tail).endswith("…")  # the one that lasts, and not the first
    assert float(first.attrib["x"]) + 5 * len(str(first[0].tail)) < float(second.attrib["x"])


VALUES = st.lists(st.none() | st.booleans() | st.floats() | st.text(max_size=5), max_size=8)


@given(st.text(), st.lists(st.tuples(st.text(), VALUES), max_size=4))
def test_any_text_and_any_value_give_one_well_formed_picture(
    title: str, named: list[tuple[str, list[object]]]
) -> None:
    tracks = [track(*values, name=name) for name, values in named if values]
    first = plot(title, tracks)
    assert first == plot(title, tracks)
    root = ET.fromstring(first)
    assert not [element for element in root.iter() if element.tag in {f"{SVG}script", "script"}]
