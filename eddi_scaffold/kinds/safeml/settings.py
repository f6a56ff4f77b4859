"""Reading ``safeml_config.yml``: every key with its type and range, all problems at once."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from typing import Any

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import Problem, did_you_mean, problem
from eddi_scaffold.kinds.safeml.scope import METRIC_NAMES, METRICS, SafeMLFile, SafeMLSettings
from eddi_scaffold.yaml_text.nodes import (
    Map,
    Node,
    Scalar,
    as_text,
    describe,
    is_null,
    read_map,
    value_11,
)

MAX_WINDOW = 1_000_000
REQUIRED = ("window_size", "reference_sample_file", "significance_level", "distance_metric")
"""The keys of SESAME D7.2 Fig 23 without which nothing can be compared."""

_NUMBER = re.compile(r"[-+]?(\d+(\.\d*)?|\.\d+)([eE][-+]?\d+)?", re.ASCII)


class _Wrong(Exception):  # noqa: N818 - control flow inside this module
    """A value is not what its key expects; the text states what is expected."""


def read_settings(source: Source) -> tuple[SafeMLSettings | None, list[Problem]]:
    """Read a configuration.

    Returns:
        The settings, ``None`` when a problem is an error (L001), and all problems.
    """
    root, problems = read_map(source, "L001")
    if root is None:
        return None, problems
    problems += _unknown(root)
    problems += [
        problem("L001.missing", root.place, key=key, shown=_SHOWN[key])
        for key in REQUIRED
        if root.get(key) is None
    ]
    values: dict[str, Any] = {}
    for key, node in root.entries:
        if key.text in KEYS:
            try:
                values[key.text] = KEYS[key.text](node)
            except _Wrong as wrong:
                problems.append(_problem(key.text, node, str(wrong)))
    if problems:
        return None, problems
    values["metric"] = values.pop("distance_metric")
    places = {key.text: node.place for key, node in root.entries}
    return SafeMLSettings(**values, places={"": root.place, **places}), []


def _unknown(root: Map) -> list[Problem]:
    return [
        problem(
            "L001.unknown_key",
            key.place,
            hint=did_you_mean(key.text, KEYS) or f"known keys: {', '.join(KEYS)}",
            key=key.text,
        )
        for key, _ in root.entries
        if key.text not in KEYS
    ]


def _problem(key: str, node: Node, expected: str) -> Problem:
    if key != "distance_metric":
        hint = _INSTEAD.get((as_text(node) or "").lower()) if key == "array_backend" else None
        return problem(
            "L001.value", node.place, hint=hint, key=key, expected=expected, actual=describe(node)
        )
    given = as_text(node)
    near = did_you_mean(given, METRICS) if given is not None else None
    return problem(
        "L001.metric",
        node.place,
        hint=near or f"there are: {', '.join(METRICS)}",
        key=key,
        actual=describe(node),
    )


def _number(node: Node) -> float:
    """Return a number; a text is one when it reads as one (YAML 1.1 takes ``1e-3`` as a text)."""
    value = value_11(node) if isinstance(node, Scalar) else None
    if isinstance(value, str) and len(value) <= 64 and _NUMBER.fullmatch(value):
        value = float(value)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise _Wrong
    if isinstance(value, float) and not math.isfinite(value):
        raise _Wrong
    return value


def _read_integer(low: int, high: int, expected: str) -> Callable[[Node], int]:
    def read(node: Node) -> int:
        try:
            value = _number(node)
        except _Wrong:
            raise _Wrong(expected) from None
        if value != int(value) or not low <= value <= high:
            raise _Wrong(expected)
        return int(value)

    return read


def _components(node: Node) -> int | None:
    if is_null(node):
        return None
    expected = "a whole number of components, or null to test the features themselves,"
    return _read_integer(0, 10**9, expected)(node) or None


def _between(expected: str, high: float) -> Callable[[Node], float]:
    def read(node: Node) -> float:
        try:
            value = _number(node)
        except _Wrong:
            raise _Wrong(expected) from None
        if not 0.0 < value < high:
            raise _Wrong(expected)
        return float(value)

    return read


def _text(expected: str) -> Callable[[Node], str]:
    def read(node: Node) -> str:
        text = as_text(node)
        if not text or "\0" in text:
            raise _Wrong(expected)
        return text

    return read


def _boolean(node: Node) -> bool:
    value = value_11(node) if isinstance(node, Scalar) else None
    if not isinstance(value, bool):
        raise _Wrong("true or false")
    return value


def _one_of(*known: str) -> Callable[[Node], str]:
    def read(node: Node) -> str:
        text = as_text(node)
        if text not in known:
            raise _Wrong(" or ".join(known) if len(known) < 3 else f"one of {', '.join(known)}")
        return text

    return read


def _metric(node: Node) -> str:
    text = as_text(node)
    if text is None or text not in METRICS:
        raise _Wrong
    return METRICS[text]


_FROM_1 = "a whole number from 1 on"
KEYS: Mapping[str, Callable[[Node], Any]] = {
    "window_size": _read_integer(
        1, MAX_WINDOW, f"a whole number of samples from 1 to {MAX_WINDOW}"
    ),
    "reference_sample_file": _text("the name of a CSV file"),
    "significance_level": _between("a probability between 0 and 1", 1.0),
    "distance_metric": _metric,
    "n_components": _components,
    "standardize": _boolean,
    "residual_test": _boolean,
    "calibration": _one_of("auto", "stream", "iid"),
    "calibration_stride": _read_integer(1, 10**9, _FROM_1),
    "stride": _read_integer(1, 10**6, _FROM_1),
    "on_omission": _one_of("hold", "clear"),
    "max_age": _between("a number of seconds above 0", 1e18),
    "input_dtype": _one_of("auto", "float32", "float64"),
    "array_backend": _one_of("numpy", "torch"),
}
"""Each key, and what reads its value."""
_INSTEAD = dict.fromkeys(
    ("tensorflow", "tf"), "write `torch` for the same GPU, or `numpy`: the distances are the same"
)
_SHOWN = {
    "window_size": "100",
    "reference_sample_file": "reference_sample.csv",
    "significance_level": "0.1",
    "distance_metric": "KolmogorovSmirnovDistance",
}


def export(file: SafeMLFile, name: str, reference: str = "reference.csv") -> Mapping[str, str]:
    """Return configuration and reference, the first with every key written out."""
    settings = file.settings
    lines = [
        f"window_size: {settings.window_size}",
        f"reference_sample_file: {reference}",
        f"significance_level: {settings.significance_level!r}",
        f"distance_metric: {METRIC_NAMES[settings.metric]}",
        f"n_components: {_yaml(settings.n_components)}",
        f"standardize: {_yaml(settings.standardize)}",
        f"residual_test: {_yaml(settings.residual_test)}",
        f"calibration: {settings.calibration}",
        f"stride: {settings.stride}",
        f"on_omission: {settings.on_omission}",
        f"input_dtype: {settings.input_dtype}",
        f"array_backend: {settings.array_backend}",
    ]
    if settings.calibration_stride is not None:
        lines.append(f"calibration_stride: {settings.calibration_stride}")
    if settings.max_age is not None:
        lines.append(f"max_age: {settings.max_age!r}")
    text = file.reference.source.data.decode("utf-8-sig")
    return {f"{name}.yml": "\n".join(lines) + "\n", reference: text}


def _yaml(value: float | None) -> str:
    return "null" if value is None else str(value).lower()
