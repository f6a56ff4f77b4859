"""The one table of units."""

from __future__ import annotations

from fractions import Fraction

import pytest

from eddi_scaffold.common import units
from eddi_scaffold.common.files import Source
from eddi_scaffold.kinds import kinds
from tests.data_files import tabled
from tests.monitors.test_binding import SPEED


def test_every_spelling_is_one_unit_and_every_dimension_has_a_base() -> None:
    every = [one for unit in units.UNITS for one in (unit.symbol, *unit.names)]
    assert len(every) == len(set(every))
    for unit in units.UNITS:
        assert any(o.dimension == unit.dimension and o.factor == 1 for o in units.UNITS)
        assert not unit.root or units.find(unit.root) is not None


@tabled
def test_conversions_are_the_nearest_double(value, given, wanted, expected):
    assert units.converted(value, given, wanted) == expected


@pytest.mark.parametrize(("one", "other"), [("degC", "K"), ("m", "s"), ("m", "fortnight")])
def test_what_no_factor_converts(one: str, other: str) -> None:
    assert units.factor(one, other) is None


def test_factors_are_exact_and_squares_have_roots() -> None:
    assert units.convertible("rad")["rad"] == (1, 1)
    assert units.factor("FIT", "1/h") == Fraction(1, 10**9)
    assert units.factor("rpm", "1/min") == 1
    assert units.root("m^2/s^4") == "m/s^2"
    assert (units.root("m"), units.root(None), units.root("")) == (None, None, None)


@pytest.mark.parametrize("uom", ["deg", "rad", "percent", "V", "A", "degC", "m/s^2", "rad/s"])
def test_units_of_robots_are_units_of_conserts(uom: str) -> None:
    text = SPEED.replace("uom: m", f"uom: {uom}")
    reading = kinds()["consert"].model_class.read_file(Source("speed.yml", text.encode()), ())
    assert [problem.code for problem in reading.problems if problem.level == "error"] == []
    (one,) = reading.models[0].inputs()
    assert one.unit == uom
