"""SafeML monitors of one number."""

from collections.abc import Iterator

from tests.deployments.pool.readings import Reading
from tests.deployments.pool.templates import Config, Slot, Template, dump

ARRAY = Reading("array", "std_msgs/Float64MultiArray", (), "float[]", field="data")
"""It has no leaves: what is unknown of it is the verdict, which its completion draws."""
USUAL = (0.5, 9.5, 2.5, 7.5, 5.0)
FAR = 90.0


def scopes() -> Iterator[Template]:
    """Yield a monitor for each way to go on without a verdict."""
    for mode in ("hold", "clear"):
        name = f"scope_{mode}"
        file, reference = f"{name}_safeml.yml", f"{name}_reference.csv"
        settings = {
            "window_size": 5,
            "reference_sample_file": reference,
            "significance_level": 0.02,
            "distance_metric": "KolmogorovSmirnovDistance",
            "n_components": None,
            "residual_test": False,
            "calibration": "iid",
            "on_omission": mode,
            "max_age": 1.2,
            "input_dtype": "float64",
        }
        config = Config(name, "SafeML", ("config", file))
        slot = Slot("s_x", ARRAY, 1.2, good=USUAL)
        config.source(slot)
        config.inputs.append(
            {"id": "frame", "type": "float[]", "requires": ["s_x"], "field": "data"}
        )
        rows = "".join(f"{7 * k % 20 / 2}\n" for k in range(20))
        files = {file: dump(settings), reference: rows, f"{name}_config.yml": config.text()}
        yield Template(name, "safeml", files, (slot,), {"scope": "/status", "verdict": ""})
