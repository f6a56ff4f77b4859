"""Reductions of lists, where a text of an event cannot show it."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from eddi_runtime.expressions import reduced
from eddi_runtime.expressions.expression import gather
from eddi_runtime.expressions.lists import MAX_ELEMENTS, number_in

from eddi_scaffold.program.lists import Element, Part, Reduction, reduction_lines
from eddi_scaffold.program.running import module_of

from .event_models import SECOND, monitor

LIST = Part("s.r[*]", "number", True, None, False)
PLAIN = Reduction(
    *("list_min", (LIST,), (Element("input", (), 0, True),), 0),
    *((), None, None, None, (), False),
)


class Reducer:
    def __init__(self, op="list_min", **more):
        reduction = replace(PLAIN, op=op, **more)
        lines = ["from eddi_runtime.expressions import lists", "class Made:"]
        lines += reduction_lines(0, "reduced", reduction, "lists.")
        self._reduce = module_of("\n".join(lines), "reduction").Made().reduce_0

    def value(self, raws):
        return reduced(self._reduce, raws)


def scan(low, high):
    angles = [Part(name, "number", False, None, False) for name in ("start", "end", "step")]
    return Reducer(inputs=(LIST, *angles), angles=(1, 2, 3), sector=(low, high))


def test_arrays_of_numpy_and_bytes_are_lists():
    one = Reducer()
    assert one.value([np.array([3.0, 2.0], np.float32)]) == (2.0, "")
    assert one.value([bytes([3, 2])]) == (2.0, "")
    for wrong in ("text", 3.0, object()):
        assert one.value([wrong])[0] is None
    assert one.value([None]) == (None, "no s.r[*]")


def test_too_many_elements_are_unknown():
    one = Reducer()
    assert one.value([[1.0] * MAX_ELEMENTS]) == (1.0, "")
    assert one.value([[1.0] * (MAX_ELEMENTS + 1)])[0] is None


@pytest.mark.parametrize(
    ("start", "end", "step", "wanted"),
    [
        (-1.0, 1.0, 0.5, 2.0),  # the elements 1 to 3
        (1.0, -1.0, -0.5, 2.0),  # a scan that turns the other way
        (-1.0, 1.0, 0.0, None),
        (-1.0, 1.0, math.nan, None),
        (-1.0, 1.0, math.inf, None),
        (-1.0, 1.7, 0.5, 2.0),  # one increment and a half off at most
        (-1.0, 1.8, 0.5, None),
        (-0.2, 0.2, 0.1, None),  # not wholly within the scan
    ],
)
def test_sectors(start, end, step, wanted):
    values = [1.0, 3.0, 2.0, 4.0, 0.5]
    assert scan(-0.3, 0.3).value([values, start, end, step])[0] == wanted


def test_every_element_of_a_sector_is_in_it_by_its_angle():
    for count in (2, 7, 360, 1081):
        step = 4.712 / (count - 1)
        angles = [-2.356 + k * step for k in range(count)]
        for low, high in ((-2.3, 2.3), (-0.5, 0.7), (0.0, 0.001)):
            wanted = [a for a in angles if low - step / 2 <= a <= high + step / 2]
            assert scan(low, high).value([angles, -2.356, 2.356, step])[0] == wanted[0]


def test_empty_lists_of_messages_and_of_numbers():
    found = {}
    for op in ("list_sum", "list_count", "list_any", "list_all", "list_min"):
        kind = "bool" if op in ("list_count", "list_any", "list_all") else "number"
        inputs = (replace(LIST, type=kind),)
        found[op] = (
            Reducer(op, inputs=inputs, messages=True).value([[]])[0],
            Reducer(op, inputs=inputs).value([[]])[0],
        )
    assert found == {
        "list_sum": (0.0, None),
        "list_count": (0.0, None),
        "list_any": (False, None),
        "list_all": (None, None),
        "list_min": (None, None),
    }


def test_sums_that_no_double_holds_are_unknown():
    for op in ("list_sum", "list_average", "list_stddev"):
        assert Reducer(op).value([[1e308, 1e308, -1e308 * (op == "list_stddev")]])[0] is None
    infinite = Reducer("list_sum", inputs=(replace(LIST, infinite=True),))
    assert infinite.value([[math.inf, -math.inf]])[0] is None


@pytest.mark.parametrize(
    ("text", "number"),
    [("24.5", 24.5), ("-3", -3.0), (".5", 0.5), ("1e3", 1000.0), (" 7\t", 7.0)]
    + [
        (text, None)
        for text in ("", "24V", "nan", "inf", "1_0", "0x10", "1e999", "\u0663", "9" * 200)
    ],
)
def test_numbers_in_texts(text, number):
    found = number_in(text)
    assert found == number or (number is None and math.isnan(found))


def test_an_event_monitor_reads_the_list():
    reduction = {
        "name": "MIN(x[*])",
        "reduction": replace(PLAIN, inputs=(replace(LIST, name="x"),)),
    }
    inputs = {"MIN(x[*])": {"id": "x"}}
    one = monitor(("gt", "x", 5), variables=("x",), x=reduction, inputs=inputs)
    given = SimpleNamespace()
    setattr(given, one.inputs[0].attribute, [7.0, 6.0])
    (event,) = one.execute_step(given, 0)
    assert event["verdict"] is True
    setattr(given, one.inputs[0].attribute, [7.0, math.nan])
    (event,) = one.execute_step(given, SECOND)
    assert event["verdict"] is None
    assert one.faults() == {"x": "1 of 2 elements are not known"}


def test_what_stands_in_lists_of_messages():
    boxes = [SimpleNamespace(score=0.5), SimpleNamespace(), SimpleNamespace(score=0.1)]
    message = SimpleNamespace(seen=[SimpleNamespace(boxes=boxes), SimpleNamespace(boxes=[])])
    assert gather(message, ["seen", ["*"], "boxes", ["*"], "score"]) == [0.5, None, 0.1]
    assert gather(message, ["seen", 0, "boxes", ["*", 1, 2], "score"]) == [None, 0.1]
    with pytest.raises(LookupError, match="is beyond the 3 elements"):
        gather(message, ["seen", 0, "boxes", ["*", 1, 3], "score"])
