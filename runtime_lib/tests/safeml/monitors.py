"""SafeML monitors for tests, made of rows and a threshold."""

from types import SimpleNamespace

import numpy as np

from eddi_scaffold.compiling.document import check_document, digest_of
from eddi_scaffold.compiling.execution import build
from eddi_scaffold.kinds.safeml.design import Design, DesignSpec

NAMES = {
    "ks": "KolmogorovSmirnovDistance",
    "cvm": "CramerVonMisesDistance",
    "ad": "AndersonDarlingDistance",
}


def document(rows, *, metric="ks", settings=(), **model):
    """Return a model document; its tables are in it."""
    spec = DesignSpec(
        components=model.get("components"),
        standardize=model.get("standardize", False),
        residual=model.get("residual_test", False),
        halves=model.get("halves", False),
        single=model.get("input_dtype") == "float32",
    )
    design = Design(np.array(rows), spec)
    axes = None
    if design.table is not None:
        axes = {"table": design.table.tolist(), "residual_floor": design.floor}
    own = {
        "reference": {"name": "reference.csv", "rows": len(rows), "features": len(rows[0])},
        "sample": design.sample.tolist(),
        "axes": axes,
        "metric": NAMES[metric],
        "components": None,
        "standardize": False,
        "residual_test": False,
        "halves": False,
        "input_dtype": "float64",
        "window_size": 4,
        "stride": 1,
        "significance_level": 0.1,
        "threshold": 0.7,
        "threshold_theoretical": 0.6,
        "threshold_scaled": 28,
        "threshold_theoretical_scaled": 24,
    }
    made = {
        "format": 1,
        "kind": "safeml",
        "id": "scope",
        "source": {},
        "inputs": [{"id": "sample", "attribute": "sample", "requires": [], "every_message": True}],
        "model": {**own, **model},
        "settings": {
            "on_omission": "hold",
            "max_age": None,
            "array_backend": "numpy",
            **dict(settings),
        },
    }
    return {**made, "sha256": digest_of(made)}


def monitor(rows, **more):
    return build(check_document(document(rows, **more), "model.json"))


def give(value):
    return SimpleNamespace(sample=value)


def step(one, value, seconds=0.0):
    return one.execute_step(give(value), round(seconds * 1e9))
