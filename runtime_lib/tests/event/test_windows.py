"""Windows against their definition: every sum is that of what is inside, whatever was before."""

from __future__ import annotations

import math
import random
import statistics

import pytest
from eddi_runtime.expressions import stacks, windows

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
