"""What must hold of every model: later, faster and more failures never look safer."""

import json

from hypothesis import given
from hypothesis import strategies as st

from eddi_scaffold.common.problems import has_errors
from eddi_scaffold.kinds.reliability.system import TYPES
from tests.kinds.reliability.monitors import at_start, everything, read_text, sound

RATES = st.floats(1e-9, 1e3)


def chain(a: float, b: float, c: float, horizon: float) -> str:
    return (
        f"horizon: {horizon!r} h\nmodels: {{c: {{type: markov, initial: up, fail: down, arcs: ["
        f"{{from: up, to: half, rate: {a!r} 1/h}}, {{from: half, to: down, rate: {b!r} 1/h}}, "
        f"{{from: up, to: down, rate: {c!r} 1/h}}]}}}}\n"
    )


@given(RATES, RATES, RATES, st.floats(1e-6, 1e4), st.floats(1.0, 100.0))
def test_p_fail_grows_with_horizon_and_rates(
    a: float, b: float, c: float, horizon: float, factor: float
) -> None:
    base = at_start(sound(chain(a, b, c, horizon))).p_fail
    slack = 1.0 + 1e-10
    assert base <= at_start(sound(chain(a, b, c, horizon * factor))).p_fail * slack
    assert base <= at_start(sound(chain(a, b * factor, c, horizon))).p_fail * slack
    assert base <= at_start(sound(chain(a, b, c * factor, horizon))).p_fail * slack


KEYS = "type of rate k gates events arcs model p observe initial fail models a top thresholds"
STRUCTURES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.text("ab:{}[], ", max_size=5),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(st.sampled_from(KEYS.split()), inner, max_size=4)
    ),
    max_leaves=12,
)


@given(STRUCTURES, st.sampled_from(TYPES))
def test_any_structure_is_read_or_refused(data: object, kind: str) -> None:

    units = {"m": {"type": "k_out_of_n", "k": 1, "rate": "1 1/h"}}
    entry = {**(data if isinstance(data, dict) else {}), "type": kind}
    for content in (
        {"models": {"m": data}},
        {"models": {"m": entry}},
        {"models": units, "thresholds": data, "top": data},
    ):
        text = json.dumps(content)
        assert read_text(text)[0] is not None or has_errors(everything(text))
