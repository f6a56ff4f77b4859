"""The ``model`` and ``settings`` parts of the model file of a SafeML monitor, checked."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from eddi_scaffold.compiling.document import ModelError, ModelFile, take

METRICS = {
    "KolmogorovSmirnovDistance": "ks",
    "CramerVonMisesDistance": "cvm",
    "AndersonDarlingDistance": "ad",
}
BACKENDS = ("numpy", "torch")
"""What ``array_backend:`` may be."""

_FILE = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,99}")


@dataclass(frozen=True)
class Table:
    """Numbers, by themselves or in a file of doubles that lies beside ``compiled.py``.

    Attributes:
        rows: how many.
        columns: how many.
        numbers: row by row, ``None`` when they are in the file.
        file: its name, empty for none.
        sha256: of the file.
    """

    rows: int
    columns: int
    numbers: Sequence[Sequence[float]] | None
    file: str = ""
    sha256: str = ""


@dataclass(frozen=True)
class Axes:
    """Principal axes.

    Attributes:
        table: means, divisors and the axes: one number for each feature.
        floor: length of a residual that counts as 0; ``None`` when the residual is not tested.
    """

    table: Table
    floor: float | None


@dataclass(frozen=True)
class SafeMLData:
    """What the monitor is made of.

    Attributes:
        about: what the reference is, for people.
        sample: the features, each ascending; with axes the rows of the reference.
        axes: ``None`` when the features themselves are tested.
        metric: ``ks``, ``cvm`` or ``ad``.
        metric_name: its name in the configuration.
        window_size: samples in a window.
        stride: only every so manieth sample enters the window.
        significance_level: per step, over all tests.
        threshold: of every test; n m D for ``ks``.
        threshold_theoretical: the same for independent samples.
        single: samples come as float32.
        hold: the last verdict is kept while there is none; else it becomes false.
        max_age: seconds without a sample after which the window is emptied; ``None``: never.
        array_backend: library of the arrays.
    """

    about: str
    sample: Table
    axes: Axes | None
    metric: str
    metric_name: str
    window_size: int
    stride: int
    significance_level: float
    threshold: float
    threshold_theoretical: float
    single: bool
    hold: bool
    max_age: float | None
    array_backend: str

    @property
    def size(self) -> int:
        """Number of reference values of each test, n."""
        return self.sample.columns if self.axes is None else self.sample.rows


def read_safeml(model_file: ModelFile) -> SafeMLData:
    """Check the model and its settings.

    Raises:
        ModelError: a part is missing or wrong.
    """
    if len(model_file.inputs) != 1:
        raise ModelError("", f"one input is expected, not {len(model_file.inputs)}")
    model, settings = model_file.model, model_file.settings
    name = take(model, "metric", str, "the model")
    if name not in METRICS:
        raise ModelError("", f"the metric {name!r} is not known")
    metric = METRICS[name]
    kind, suffix = (int, "_scaled") if metric == "ks" else ((int, float), "")
    reference = take(model, "reference", dict, "the model")
    axes = _axes(model)
    sample = _table(model, "sample", "the model")
    features = sample.rows if axes is None else sample.columns
    if features != take(reference, "features", int, "'reference'"):
        raise ModelError("", f"'sample' has {features} features, the model other ones")
    if axes is not None and (axes.table.columns != features or axes.table.rows < 3):
        raise ModelError("", f"'axes' are none of {features} features")
    return SafeMLData(
        about=f"{take(reference, 'name', str, 'the reference')}: "
        f"{take(reference, 'rows', int, 'the reference')} rows, {features} features",
        sample=sample,
        axes=axes,
        metric=metric,
        metric_name=name,
        window_size=_positive(model, "window_size"),
        stride=_positive(model, "stride"),
        significance_level=take(model, "significance_level", float, "the model"),
        threshold=take(model, f"threshold{suffix}", kind, "the model"),
        threshold_theoretical=take(model, f"threshold_theoretical{suffix}", kind, "the model"),
        single=take(model, "input_dtype", str, "the model") == "float32",
        hold=_one_of(settings, "on_omission", ("hold", "clear")) == "hold",
        max_age=_max_age(settings.get("max_age")),
        array_backend=_one_of(settings, "array_backend", BACKENDS),
    )


def _axes(model: Mapping[str, Any]) -> Axes | None:
    if "axes" not in model:
        reason = "the model has no 'axes', an older eddi-scaffold made it"
        raise ModelError("", f"{reason}: give `eddi-scaffold upgrade` the model again, with -m")
    if model["axes"] is None:
        return None
    axes = take(model, "axes", dict, "the model")
    floor = axes.get("residual_floor")
    if floor is not None:
        floor = float(take(axes, "residual_floor", (int, float), "'axes'"))
    return Axes(_table(axes, "table", "'axes'"), floor)


def _table(item: Mapping[str, Any], key: str, where: str) -> Table:
    found = take(item, key, (list, dict), where)
    where = f"{key!r} of {where}"
    if isinstance(found, list):
        return _numbers(found, where)
    shape = take(found, "shape", list, where)
    if len(shape) != 2 or not all(type(size) is int and size > 0 for size in shape):
        raise ModelError("", f"'shape' of {where} is not a pair of whole numbers above 0")
    file = take(found, "file", str, where)
    if _FILE.fullmatch(file) is None:
        raise ModelError("", f"{file!r} is not the name of a file beside the code")
    rows, columns = shape
    return Table(rows, columns, None, file, take(found, "sha256", str, where))


def _numbers(rows: list[Any], where: str) -> Table:
    if not rows or not all(isinstance(row, list) and row for row in rows):
        raise ModelError("", f"{where} is not a list of rows")
    if len({len(row) for row in rows}) != 1:
        raise ModelError("", f"{where}: the rows differ in length")
    if not all(type(one) in (int, float) and math.isfinite(one) for row in rows for one in row):
        raise ModelError("", f"{where} holds what is no number")
    return Table(len(rows), len(rows[0]), [list(map(float, row)) for row in rows])


def _positive(model: Mapping[str, Any], key: str) -> int:
    value: int = take(model, key, int, "the model")
    if value < 1:
        raise ModelError("", f"{key!r} of the model is below 1")
    return value


def _one_of(settings: Mapping[str, Any], key: str, known: Sequence[str]) -> str:
    value: str = take(settings, key, str, "'settings'")
    if value not in known:
        raise ModelError("", f"{key!r} is {value!r}, not one of {', '.join(known)}")
    return value


def _max_age(value: Any) -> float | None:
    if value is None:
        return None
    if isinstance(value, (int, float)) and not isinstance(value, bool) and 0 < value < 1e18:
        return float(value)
    raise ModelError("", "'max_age' is not a number of seconds above 0")
