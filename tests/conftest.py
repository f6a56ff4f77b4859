"""Hypothesis profiles: `quick` in every run, `--hypothesis-profile=long` for thousands of examples.

`--update-golden` writes the expected packages anew.
"""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, settings

collect_ignore = ["golden"]  # generated packages, whose tests run where they belong

settings.register_profile(
    "quick", max_examples=50, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck)
)
settings.register_profile(
    "long", max_examples=5000, deadline=None, suppress_health_check=list(HealthCheck)
)
settings.load_profile("quick")


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--update-golden", action="store_true", help="accept what is generated now")
