"""Reading ``safeml_config.yml``: every key with its type and range, all problems at once."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import Problem, did_you_mean, problem
from eddi_scaffold.kinds.safeml.scope import METRIC_NAMES, METRICS, SafeMLFile, SafeMLSettings
from eddi_scaffold.yaml_text import nodes as y

MAX_WINDOW = 1_000_000
_REQUIRED = {
    "window_size": "100",
    "reference_sample_file": "reference_sample.csv",
    "significance_level": "0.1",
    "distance_metric": "KolmogorovSmirnovDistance",
}
"""The keys of SESAME D7.2 Fig 23 without which nothing can be compared, each with a value."""
_NUMBER = re.compile(r"[-+]?(\d+(\.\d*)?|\.\d+)([eE][-+]?\d+)?", re.ASCII)


def read_settings(source: Source) -> tuple[SafeMLSettings | None, list[Problem]]:
    """Read a configuration, ``None`` when a problem is an error (L001)."""
    root, problems = y.read_map(source, "L001")
    if root is None:
        return None, problems
    problems += [
        problem("L001.missing", root.place, key=key, shown=value)
        for key, value in _REQUIRED.items()
        if root.get(key) is None
    ]
    values: dict[str, Any] = {}
    for name, node in root.entries:
        key = name.text
        if key not in KEYS:
            hint = did_you_mean(key, KEYS) or f"known keys: {', '.join(KEYS)}"
            problems.append(problem("L001.unknown_key", name.place, hint=hint, key=key))
            continue
        read, expected = KEYS[key]
        try:
            values[key] = read(node)
        except (TypeError, ValueError):
            fields = {"key": key, "expected": expected, "actual": y.describe(node)}
            problems.append(
                problem("L001.value", node.place, hint=_hint(key, y.as_text(node)), **fields)
            )
    if problems:
        return None, problems
    values["metric"] = values.pop("distance_metric")
    places = {key.text: node.place for key, node in root.entries}
    return SafeMLSettings(**values, places={"": root.place, **places}), []


def _hint(key: str, text: str | None) -> str | None:
    if key == "distance_metric":
        return did_you_mean(text or "", METRICS) or f"there are: {', '.join(METRICS)}"
    if key == "array_backend" and (text or "").lower() in ("tensorflow", "tf"):
        return "write `torch` for the same GPU, or `numpy`: the distances are the same"
    return None


def _number(node: y.Node) -> float:
    """Return a number; a text is one when it reads as one (YAML 1.1 takes ``1e-3`` as a text)."""
    value = y.value_11(node) if isinstance(node, y.Scalar) else None
    if isinstance(value, str) and len(value) <= 64 and _NUMBER.fullmatch(value):
        value = float(value)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise TypeError
    if isinstance(value, float) and not math.isfinite(value):
        raise ValueError
    return value


def _integer(node: y.Node, low: int, high: int) -> int:
    value = _number(node)
    if value != int(value) or not low <= value <= high:
        raise ValueError
    return int(value)


def _above_0(node: y.Node, below: float) -> float:
    value = _number(node)
    if not 0.0 < value < below:
        raise ValueError
    return float(value)


def _text(node: y.Node) -> str:
    text = y.as_text(node)
    if not text or "\0" in text:
        raise ValueError
    return text


def _boolean(node: y.Node) -> bool:
    value = y.value_11(node) if isinstance(node, y.Scalar) else None
    if not isinstance(value, bool):
        raise TypeError
    return value


def _choice(known: Mapping[str, str], node: y.Node) -> str:
    text = y.as_text(node)
    if text is None or text not in known:
        raise ValueError
    return known[text]


def _one_of(*known: str) -> tuple[Callable[[y.Node], str], str]:
    expected = " or ".join(known) if len(known) < 3 else f"one of {', '.join(known)}"
    return partial(_choice, dict(zip(known, known, strict=True))), expected


_FROM_1 = "a whole number from 1 on"
KEYS: Mapping[str, tuple[Callable[[y.Node], Any], str]] = {
    "window_size": (
        partial(_integer, low=1, high=MAX_WINDOW),
        f"a whole number of samples from 1 to {MAX_WINDOW}",
    ),
    "reference_sample_file": (_text, "the name of a CSV file"),
    "significance_level": (partial(_above_0, below=1.0), "a probability between 0 and 1"),
    "distance_metric": (partial(_choice, METRICS), "a metric"),
    "n_components": (
        lambda node: None if y.is_null(node) else _integer(node, 0, 10**9) or None,
        "a whole number of components, or null to test the features themselves,",
    ),
    "standardize": (_boolean, "true or false"),
    "residual_test": (_boolean, "true or false"),
    "calibration": _one_of("auto", "stream", "iid"),
    "stride": (partial(_integer, low=1, high=10**6), _FROM_1),
    "on_omission": _one_of("hold", "clear"),
    "input_dtype": _one_of("auto", "float32", "float64"),
    "array_backend": _one_of("numpy", "torch"),
    "calibration_stride": (partial(_integer, low=1, high=10**9), _FROM_1),
    "max_age": (partial(_above_0, below=1e18), "a number of seconds above 0"),
}
"""Each key, in the order of an export: what reads its value, and what is expected of it."""


def export(file: SafeMLFile, name: str, reference: str = "reference.csv") -> Mapping[str, str]:
    """Return configuration and reference, the first with every key written out."""
    settings, lines = file.settings, []
    own = {
        "distance_metric": METRIC_NAMES[settings.metric],
        "reference_sample_file": reference,
    }
    for key in KEYS:
        value = own.get(key) or getattr(settings, key)
        text = str(value).lower() if isinstance(value, bool) else str(value)
        if value is not None:
            lines.append(f"{key}: {text}\n")
        elif key == "n_components":
            lines.append(f"{key}: null\n")
    text_of_reference = file.reference.source.data.decode("utf-8-sig")
    return {f"{name}.yml": "".join(lines), reference: text_of_reference}
