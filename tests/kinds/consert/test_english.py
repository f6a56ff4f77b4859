import math

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from eddi_scaffold.kinds.consert.consert import BinaryDimension, Bound, NumericDimension, Range
from eddi_scaffold.kinds.consert.read_eddi_dimensions import read_english
from tests.data_files import data_file


def _oracle() -> list[dict[str, object]]:
    path = data_file("conserts/oracle.yml")
    entries: list[dict[str, object]] = yaml.load(path.read_text(), yaml.CSafeLoader)["xml_import"]
    return entries


def test_texts_of_the_oracle_agree() -> None:
    checked = 0
    by_id = {entry["id"]: entry for entry in _oracle()}
    for entry in by_id.values():
        if "text" not in entry or "error" in entry:
            continue
        want = by_id[entry["same_as"]] if "same_as" in entry else entry
        dimension = read_english(str(entry["text"]))[0]
        assert dimension.type == want["type"]
        assert isinstance(dimension, BinaryDimension) == bool(want.get("binary"))
        if isinstance(dimension, NumericDimension):
            (covered,) = dimension.covered
            assert covered.start.value == want["start"]
            assert covered.end.value == want["end"]
            assert covered.inclusive == (want["kind"] == "Inclusive")
            assert (dimension.uom, dimension.subset) == (want["uom"], want["subset"])
        checked += 1
    assert checked == 5


def test_a_lower_bound_is_open_upwards() -> None:
    at_least = read_english("Distance >= 5.7 m")[0]
    assert at_least == NumericDimension(
        "Distance",
        (Range(Bound("5.7", 5.7), Bound("inf", math.inf), inclusive=True),),
        "Guarantee",
        "m",
    )
    above = read_english("Distance > 5.7 m")[0]
    assert isinstance(above, NumericDimension)
    assert above.covered[0].start.value == math.nextafter(5.7, math.inf)
    assert float(above.covered[0].start.text) == above.covered[0].start.value


@pytest.mark.parametrize(
    ("text", "kind", "remark"),
    [
        ("Delay < 3 minutes", "Delay3Minutes", 'the unit "minutes" is unknown'),
        ("Delay < 3 ms at most", "Delay3MsAtMost", '"3 ms at most" is not a number with a unit'),
        ("Delay < 3,5 ms", "Delay35Ms", '"3,5 ms" is not a number with a unit'),
        ("Delay == 3 ms", "Delay3Ms", "there is no operator <=, >=, <, > or bound to"),
        ("Delay <== 3 ms", "Delay3Ms", '"= 3 ms" is not a number with a unit'),
        ("< 3 ms", "3Ms", "there is nothing before the operator"),
        (" \r\nWifi Module is healthy : ASIL D \n", "WifiModuleIsHealthy", None),
    ],
)
def test_a_bound_that_cannot_be_read_is_binary_with_a_remark(
    text: str, kind: str, remark: str | None
) -> None:
    assert read_english(text) == (BinaryDimension(kind), remark)


@given(st.text())
def test_any_text_is_read(text: str) -> None:
    read_english(text)
    read_english(f"x < {text}")
