"""SafeML monitors for tests, made of rows and a threshold."""

import hashlib
from types import SimpleNamespace

from eddi_runtime.model_file import check_document, digest_of
from eddi_runtime.monitor import build

NAMES = {
    "ks": "KolmogorovSmirnovDistance",
    "cvm": "CramerVonMisesDistance",
    "ad": "AndersonDarlingDistance",
}


def document(rows, *, metric="ks", settings=(), csv=None, **model):
    """Return a model document and its CSV."""
    csv = "\n".join(",".join(map(repr, row)) for row in rows).encode() if csv is None else csv
    own = {
        "reference": {
            "file": "reference.csv",
            "sha256": hashlib.sha256(csv).hexdigest(),
            "features": len(rows[0]),
        },
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
        "requires_runtime": "0.1",
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
    return {**made, "sha256": digest_of(made)}, {"reference.csv": csv}


def monitor(rows, **more):
    made, files = document(rows, **more)
    return build(check_document(made, "model.json", files))


def give(value):
    return SimpleNamespace(sample=value)


def step(one, value, seconds=0.0):
    return one.execute_step(give(value), round(seconds * 1e9))
