"""Names derived from ids, and units."""

import ast
import keyword
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from eddi_scaffold.common import identifiers, units
from eddi_scaffold.kinds.consert import names


def test_the_reserved_words_hold_those_of_this_python():
    assert set(keyword.kwlist) | set(keyword.softkwlist) <= names.RESERVED


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
    assert names.published_class(id_) == published


@given(st.text(min_size=1))
def test_derived_names_stand_in_code(id_):
    name = identifiers.attribute(id_)
    ast.parse(f"self.{name} = 1\ndef process_{name}(self): pass")
    if not names.is_usable(id_):
        assert not names.class_name(id_).isidentifier() or not id_.isascii()


def test_factors_are_exact():
    assert units.factor("km/h", "m/s") == Fraction(5, 18)
    assert units.factor("us", "nanosecond") == 1000
    assert units.factor(None, "") == 1
    assert units.factor("m", "s") is None
    assert units.factor("fortnight", "s") is None
    assert units.convertible("ms")["us"] == (1, 1000)
    assert all(units.find(spelling) for spelling in units.spellings())
