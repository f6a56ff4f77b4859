"""SafeML -> ``config/model.json`` and the tables next to the code."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from eddi_scaffold.kinds import JsonValue
from eddi_scaffold.kinds.safeml.plan import upwards
from eddi_scaffold.kinds.safeml.reference import Table
from eddi_scaffold.kinds.safeml.scope import (
    METRIC_NAMES,
    Plan,
    ReferenceSample,
    SafeMLFile,
    SafeMLOptions,
)


def _sample(plan: Plan) -> Table:
    return Table("reference.bin", plan.design.sample)


def _axes(plan: Plan) -> Table | None:
    return None if plan.design.table is None else Table("axes.bin", plan.design.table)


def runtime_model(file: SafeMLFile, plan: Plan) -> dict[str, JsonValue]:
    """Return the ``model`` part."""
    settings, axes = file.settings, _axes(plan)
    value, test = plan.autocorrelation
    found: JsonValue = None
    if axes is not None:
        found = {"table": axes.as_json(), "residual_floor": plan.design.floor}
    return {
        "reference": _reference(file.reference),
        "sample": _sample(plan).as_json(),
        "axes": found,
        "metric": METRIC_NAMES[settings.metric],
        "window_size": settings.window_size,
        "stride": settings.stride,
        "significance_level": settings.significance_level,
        "level_per_test": upwards(plan.level),
        "tests": plan.tests,
        "reference_size": plan.n,
        "components": plan.spec.components,
        "standardize": plan.spec.standardize,
        "residual_test": plan.spec.residual,
        "halves": plan.spec.halves,
        "input_dtype": "float32" if plan.spec.single else "float64",
        "method": plan.method,
        "calibration_windows": plan.calibration.windows if plan.calibration else 0,
        "autocorrelation": {"value": round(value, 6), "test": plan.labels[test]},
        "constant_features": list(plan.constant),
        **_thresholds(plan),
    }


def settings(connection: SafeMLOptions) -> dict[str, JsonValue]:
    """Return the ``settings`` part."""
    own = connection.plan.settings
    return {
        "on_omission": own.on_omission,
        "max_age": connection.max_age,
        "array_backend": own.array_backend,
    }


def data_files(plan: Plan) -> Mapping[str, bytes]:
    """Return the tables that are too large for the model."""
    axes = _axes(plan)
    return {**_sample(plan).files, **(axes.files if axes is not None else {})}


def _reference(reference: ReferenceSample) -> dict[str, JsonValue]:
    rows, features = reference.rows.shape
    return {
        "name": reference.source.file_name,
        "sha256": reference.source.sha256,
        "rows": int(rows),
        "features": int(features),
    }


def _thresholds(plan: Plan) -> dict[str, JsonValue]:
    """Return thresholds as people know them, and those of Kolmogorov-Smirnov as n m D."""
    quantile = plan.calibration.quantile if plan.calibration else None
    found: dict[str, JsonValue] = {
        "threshold": upwards(plan.scale(plan.threshold)),
        "threshold_theoretical": upwards(plan.scale(plan.theoretical)),
        "calibration_quantile": None if quantile is None else upwards(plan.scale(quantile)),
    }
    if plan.settings.metric == "ks":
        found["threshold_scaled"] = int(plan.threshold)
        found["threshold_theoretical_scaled"] = int(plan.theoretical)
    return found


def limits(document: Mapping[str, Any]) -> Mapping[str, float]:
    """Return the age after which a frame is an omission."""
    age = document["settings"]["max_age"]
    return {} if age is None else {spec["id"]: age for spec in document["inputs"]}


def support(document: Mapping[str, Any]) -> Mapping[str, frozenset[str]]:
    """Return what "in scope" rests on: the frames."""
    return {"in_scope": frozenset(spec["id"] for spec in document["inputs"])}
