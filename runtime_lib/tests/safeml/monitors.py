"""SafeML monitors for tests, made of rows and a threshold."""

from types import SimpleNamespace

import numpy as np

from eddi_scaffold.common.files import Source
from eddi_scaffold.kinds.safeml.scope import (
    Design,
    Plan,
    ReferenceSample,
    SafeMLFile,
    SafeMLOptions,
    SafeMLSettings,
)
from runtime_lib.tests.bound_models import bound_input, bound_model


def scope(
    rows,
    *,
    metric="ks",
    threshold=None,
    spec=None,
    max_age=None,
    stride=1,
    reference="reference.csv",
    name="scope",
    input_keys=(),
    **settings,
):
    is_ks = metric == "ks"
    threshold = threshold or (28 if is_ks else 0.7)
    settings = SafeMLSettings(4, reference, 0.1, metric, stride=stride, **settings)
    design = Design(np.array(rows), **(spec or {}))
    single, lower = (spec or {}).get("single", False), 24 if is_ks else 0.6
    plan = Plan(settings, design, single, 0.1, lower, None, threshold, "exact", (0.0, 0))
    file = SafeMLFile(settings, ReferenceSample(Source(reference, b""), np.array(rows)))
    keys = {"every_message": True, **dict(input_keys)}
    input_id = keys.pop("id", "sample")
    options = SafeMLOptions(plan, "sample", max_age, None)
    return bound_model("safeml", name, file, options, [bound_input(input_id, **keys)])


def monitor(rows, **more):
    return scope(rows, **more).monitor()


def give(value):
    return SimpleNamespace(sample=value)


def step(one, value, seconds=0.0):
    return one.execute_step(give(value), round(seconds * 1e9))


def of_windows(comparison, windows):
    """Return the statistic of each test of many windows: (B, K, m) -> (B, K)."""
    shape = (comparison.tests, len(windows), comparison.m)
    series = windows.swapaxes(0, 1).reshape(comparison.tests, -1)
    ranks = (comparison.backend.ranks(comparison.reference, series, equal=e) for e in (False, True))
    lower, upper = (of.reshape(shape).swapaxes(0, 1) for of in ranks)
    is_tied = bool((lower != upper).any())
    return comparison.of_ranks(lower, upper if is_tied else None, comparison.counts(windows))
