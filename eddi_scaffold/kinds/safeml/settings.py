"""Reading ``safeml_config.yml``: every key with its type and range, all problems at once.

In an EDDI a map ``eddi.safeml`` has the same keys.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import Problem, did_you_mean, has_errors, problem
from eddi_scaffold.eddi_xml.extensions import (
    MODEL,
    SAFEML,
    ExtensionMap,
    extension_maps,
    unknown_tags,
)
from eddi_scaffold.eddi_xml.parsing import select
from eddi_scaffold.kinds.safeml.reference import read_named
from eddi_scaffold.kinds.safeml.scope import METRIC_NAMES, METRICS, SafeMLFile, SafeMLSettings
from eddi_scaffold.yaml_text import nodes as y

if TYPE_CHECKING:
    from eddi_scaffold.eddi_xml.document import EddiDocument


MAX_WINDOW = 1_000_000
_REQUIRED = {
    "window_size": "100",
    "reference_sample_file": "reference_sample.csv",
    "significance_level": "0.1",
    "distance_metric": "KolmogorovSmirnovDistance",
}
"""The keys of SESAME D7.2 Fig 23 without which nothing can be compared, each with a value."""


def read_settings(root: y.Map, file: str) -> tuple[SafeMLFile | None, list[Problem]]:
    """Read a configuration and the reference that it names, relative to its file (L001, L004)."""
    problems = [
        problem("L001.missing", root.place, key=key, shown=value)
        for key, value in _REQUIRED.items()
        if root.get(key) is None
    ]
    values: dict[str, Any] = {}
    for name, node in root.entries:
        key = name.text
        if key not in KEYS:
            similar = did_you_mean(key, KEYS) or f"known keys: {', '.join(KEYS)}"
            problems.append(problem("L001.unknown_key", name.place, hint=similar, key=key))
            continue
        read, expected = KEYS[key]
        try:
            values[key] = read(node)
        except ValueError:
            fields = {"key": key, "expected": expected, "actual": y.describe(node)}
            is_metric = key == "distance_metric"
            hint = did_you_mean(y.as_text(node) or "", METRICS) if is_metric else None
            problems.append(problem("L001.value", node.place, hint=hint, **fields))
    if problems:
        return None, problems
    values["metric"] = values.pop("distance_metric")
    places = {key.text: node.place for key, node in root.entries}
    settings = SafeMLSettings(**values, places={"": root.place, **places})
    reference, problems = read_named(file, settings)
    return (None if reference is None else SafeMLFile(settings, reference)), problems


def _number(node: y.Node) -> float:
    number = y.as_number(node)
    if number is None or not math.isfinite(number.value):
        raise ValueError
    return number.value


def _integer(node: y.Node, low: int, high: int) -> int:
    value = _number(node)
    if value != int(value) or not low <= value <= high:
        raise ValueError
    return int(value)


def _above_0(node: y.Node, below: float) -> float:
    value = _number(node)
    if not 0.0 < value < below:
        raise ValueError
    return value


def _text(node: y.Node) -> str:
    text = y.as_text(node)
    if not text or "\0" in text:
        raise ValueError
    return text


def _boolean(node: y.Node) -> bool:
    value = y.as_bool(node)
    if value is None:
        raise ValueError
    return value


def _choice(known: Mapping[str, str], node: y.Node) -> str:
    text = y.as_text(node)
    if text is None or text not in known:
        raise ValueError
    return known[text]


def _choice_of(*known: str) -> tuple[Callable[[y.Node], str], str]:
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
    "distance_metric": (partial(_choice, METRICS), f"one of {', '.join(METRICS)}"),
    "n_components": (
        lambda node: None if y.is_null(node) else _integer(node, 0, 10**9) or None,
        "a whole number of components, or null to test the features themselves,",
    ),
    "standardize": (_boolean, "true or false"),
    "residual_test": (_boolean, "true or false"),
    "calibration": _choice_of("auto", "stream", "iid"),
    "stride": (partial(_integer, low=1, high=10**6), _FROM_1),
    "on_omission": _choice_of("hold", "clear"),
    "input_dtype": _choice_of("auto", "float32", "float64"),
    "array_backend": _choice_of("numpy", "torch"),
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


DIGEST, ARTIFACT = "reference_sample_sha256", "artifact"
_KNOWN = (MODEL, *KEYS, DIGEST, ARTIFACT)


def settings_of_eddi(
    document: EddiDocument, source: Source
) -> tuple[list[tuple[ExtensionMap, Source, SafeMLFile]], list[Problem]]:
    """Read the SafeML monitors of an EDDI, and the references that they name."""
    files: list[tuple[ExtensionMap, Source, SafeMLFile]] = []
    problems: list[Problem] = []
    gids = [str(gid) for root in document.roots for gid in select(root, ".//@gid")]
    for extension_map in extension_maps(document, SAFEML):
        faults = [*unknown_tags(extension_map, _KNOWN, _KNOWN)]
        faults += [
            problem("L004.gid", value.place, hint=did_you_mean(value.text, gids), gid=value.text)
            for value in extension_map.of(ARTIFACT)
            if value.text not in gids
        ]
        if extension_map.model is not None and not has_errors(faults):
            values = extension_map.of(*KEYS)
            nodes = {v.tag: y.Scalar(v.text, plain=True, place=v.place) for v in values}
            file, more = read_settings(y.map_of(extension_map.place, nodes), source.name)
            sha256 = "" if file is None else file.reference.source.sha256
            faults += more + [
                problem("L004.digest", value.place, sha256=sha256, expected=value.text)
                for value in extension_map.of(DIGEST)
                if sha256 and value.text.lower() != sha256
            ]
            if file is not None and not has_errors(faults):
                text = "".join(f"{value.tag}: {value.text}\n" for value in values)
                files.append((extension_map, replace(source, part=text.encode()), file))
        problems += faults
    return files, problems


def as_eddi_map(name: str, file: SafeMLFile) -> tuple[str, Sequence[tuple[str, str]]]:
    """Return the map that holds the settings, with the digest of their reference."""
    (text, _) = export(file, name, file.settings.reference_sample_file).values()
    pairs = [line.partition(": ")[::2] for line in text.splitlines()]
    values = [(key, value) for key, value in pairs if value != "null"]
    return SAFEML, [(MODEL, name), *values, (DIGEST, file.reference.source.sha256)]
