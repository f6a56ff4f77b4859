"""Reductions of lists, where a text of an event cannot show it."""

from __future__ import annotations

import math
import random
import statistics
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from eddi_runtime.expressions import reduced, stacks, windows
from eddi_runtime.expressions import window as windows_of
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
    assert one.blocked() == {}


def test_what_stands_in_lists_of_messages():
    boxes = [SimpleNamespace(score=0.5), SimpleNamespace(), SimpleNamespace(score=0.1)]
    message = SimpleNamespace(seen=[SimpleNamespace(boxes=boxes), SimpleNamespace(boxes=[])])
    assert gather(message, ["seen", ["*"], "boxes", ["*"], "score"]) == [0.5, None, 0.1]
    assert gather(message, ["seen", 0, "boxes", ["*", 1, 2], "score"]) == [None, 0.1]
    with pytest.raises(LookupError, match="is beyond the 3 elements"):
        gather(message, ["seen", 0, "boxes", ["*", 1, 3], "score"])


STEP = 10**7


def play(window, samples, length):
    """Yield (value of the window, known samples that are inside)."""
    inside = []
    for k, x in enumerate(samples):
        t = k * STEP
        inside = [(at, one) for at, one in [*inside, (t, x)] if at > t - length]
        yield window.push(t, t, x), [one for _, one in inside]


def made(name, samples, capacity=1 << 20):
    length = samples * STEP
    made_of = getattr(windows, name, None) or getattr(stacks, name)
    return made_of(length, length - STEP, capacity), length


@pytest.mark.parametrize("spikes", [(), (1e16,), (1e30,), (1e16, 1e30), (1e308, 1e308, -1e308)])
def test_a_spike_that_has_left_leaves_nothing_behind(spikes):
    rng = random.Random(1)
    samples = [rng.uniform(-1, 1) for _ in range(900)]
    for k, spike in enumerate(spikes):
        samples[500 + 7 * k] = spike
    for name in ("Sum", "Average", "Deviation"):
        window, length = made(name, 100)
        for k, (value, inside) in enumerate(play(window, samples, length)):
            if k < 99 or 500 <= k < 500 + 7 * len(spikes) + 100:
                continue
            exact = {
                "Sum": math.fsum,
                "Average": lambda xs: math.fsum(xs) / len(xs),
                "Deviation": statistics.stdev,
            }[name](inside)
            assert abs(value - exact) <= 1e-12 * max(1.0, math.fsum(map(abs, inside)))


def test_infinite_sums_are_unknown_and_end():
    window, length = made("Sum", 3)
    values = [value for value, _ in play(window, [1.0, 1e308, 1e308, 1.0, 2.0, 3.0, 4.0], length)]
    assert [math.isnan(value) for value in values] == [True, True, True, True, False, False, False]
    assert values[-1] == 9.0


@pytest.mark.parametrize("name", ["Maximum", "Minimum", "Median", "Rate", "Count", "Sum"])
def test_every_buffer_keeps_to_its_capacity(name):
    window, _ = made(name, 1000, capacity=16)
    for k in range(500):
        window.push(k * STEP, k * STEP, float(-k if name == "Maximum" else k) + 1.0)
    sizes = [
        len(getattr(window, field)) for field in ("_samples", "_sorted") if hasattr(window, field)
    ]
    sizes += [len(window._front) + len(window._back)] if name == "Sum" else []
    assert max(sizes) <= 16
    assert window.overflows > 0


def test_coverage_counts_what_is_known():
    window, length = made("Average", 4)
    covered = windows_of.Covered(window, 0.5)
    nan = math.nan
    values = [
        covered.push(k * STEP, k * STEP, x)
        for k, x in enumerate([1.0, nan, 3.0, 5.0, nan, nan, nan])
    ]
    assert [None if math.isnan(v) else v for v in values] == [None, None, None, 3.0, 4.0, 4.0, None]
    assert length == 4 * STEP
