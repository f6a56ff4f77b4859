"""The SafeML part of a model file, checked."""

from __future__ import annotations

import hashlib
from typing import Any, NamedTuple, Optional, Union

from ..documents import ModelError, take
from ..model_file import ModelFile
from .arrays import NAMES, Array
from .design import DesignSpec
from .limits import METRICS
from .reference import read_rows

_NAMES = dict(
    zip(METRICS, ("KolmogorovSmirnovDistance", "CramerVonMisesDistance", "AndersonDarlingDistance"))
)


class SafeMLModel(NamedTuple):
    """What the monitor is made of.

    Attributes:
        rows: the reference file (rows, d).
        spec: what is tested.
        metric: ``ks``, ``cvm`` or ``ad``.
        metric_name: its name in the configuration.
        window_size: samples in a window.
        stride: only every so manieth sample enters the window.
        significance_level: per step, over all tests.
        threshold: of every test; n m D for ``ks``.
        threshold_theoretical: the same for independent samples.
        hold: the last verdict is kept while there is none; else it becomes false.
        max_age: seconds without a sample after which the window is emptied; ``None``: never.
        array_backend: library of the arrays.
    """

    rows: Array
    spec: DesignSpec
    metric: str
    metric_name: str
    window_size: int
    stride: int
    significance_level: float
    threshold: Union[int, float]
    threshold_theoretical: Union[int, float]
    hold: bool
    max_age: Optional[float]
    array_backend: str


def read_safeml(model_file: ModelFile) -> SafeMLModel:
    """Check the model and read its reference.

    Raises:
        ModelError: a part is missing or wrong, or the reference is not the one that the
            thresholds were found with.
    """
    model, settings = model_file.model, model_file.settings
    name = take(model, "metric", str, "the model")
    metric = next((short for short, long in _NAMES.items() if long == name), None)
    if metric is None:
        raise ModelError("", f"the metric {name!r} is not known")
    components = model.get("components")
    spec = DesignSpec(
        components=None if components is None else _positive(model, "components"),
        standardize=take(model, "standardize", bool, "the model"),
        residual=take(model, "residual_test", bool, "the model"),
        halves=take(model, "halves", bool, "the model"),
        single=take(model, "input_dtype", str, "the model") == "float32",
    )
    kind = int if metric == "ks" else (int, float)
    suffix = "_scaled" if metric == "ks" else ""
    return SafeMLModel(
        rows=_rows(model_file),
        spec=spec,
        metric=metric,
        metric_name=name,
        window_size=_positive(model, "window_size"),
        stride=_positive(model, "stride"),
        significance_level=float(take(model, "significance_level", float, "the model")),
        threshold=take(model, f"threshold{suffix}", kind, "the model"),
        threshold_theoretical=take(model, f"threshold_theoretical{suffix}", kind, "the model"),
        hold=_one_of(settings, "on_omission", ("hold", "clear")) == "hold",
        max_age=_max_age(settings.get("max_age")),
        array_backend=_one_of(settings, "array_backend", NAMES),
    )


def _rows(model_file: ModelFile) -> Array:
    reference = take(model_file.model, "reference", dict, "the model")
    name = take(reference, "file", str, "'reference'")
    data = model_file.data(name)
    if hashlib.sha256(data).hexdigest() != take(reference, "sha256", str, "'reference'"):
        raise ModelError("", f"{name} changed since generation: run eddi-scaffold again")
    try:
        rows = read_rows(data)
    except ValueError as problem:
        raise ModelError("", f"{name}: {problem}") from None
    if rows.shape[1] != take(reference, "features", int, "'reference'"):
        raise ModelError("", f"{name} has {rows.shape[1]} features, the model other ones")
    return rows


def _positive(model: Any, key: str) -> int:
    value: int = take(model, key, int, "the model")
    if value < 1:
        raise ModelError("", f"{key!r} of the model is below 1")
    return value


def _one_of(settings: Any, key: str, known: Any) -> str:
    value: str = take(settings, key, str, "'settings'")
    if value not in known:
        raise ModelError("", f"{key!r} is {value!r}, not one of {', '.join(known)}")
    return value


def _max_age(value: Any) -> Optional[float]:
    if value is None:
        return None
    if isinstance(value, (int, float)) and not isinstance(value, bool) and 0 < value < 1e18:
        return float(value)
    raise ModelError("", "'max_age' is not a number of seconds above 0")
