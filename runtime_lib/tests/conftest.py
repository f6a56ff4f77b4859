"""Hypothesis profiles, the same as in the generator's tests, with fewer examples on Python 3.8.

What needs a compiled model is left out where the generator cannot run, before Python 3.10: there
``tests/rules`` steps generated packages instead.
"""

import sys

import pytest


class _NoGenerator:
    """Skips each module of tests that imports the generator."""

    def find_spec(self, name, path=None, target=None):
        if name == "eddi_scaffold":
            pytest.skip("the generator needs Python 3.10", allow_module_level=True)


if sys.version_info < (3, 10):
    sys.meta_path.insert(0, _NoGenerator())
    # what imports numpy or hypothesis before the generator
    collect_ignore_glob = ["bayesian_network/test_[!e]*", "bayesian_network/test_en*"]
    collect_ignore_glob += ["reliability/*", "safeml/*", "state_machine/*"]
    collect_ignore_glob += ["test_[mv]*.py", "test_properties.py"]
    collect_ignore_glob += ["test_clock.py", "node/test_situations.py"]  # or yaml

try:
    from hypothesis import HealthCheck, settings
except ImportError:
    pass
else:
    settings.register_profile(
        "quick",
        max_examples=15 if sys.version_info >= (3, 10) else 5,
        deadline=None,
        derandomize=True,
        suppress_health_check=list(HealthCheck),
    )
    settings.register_profile(
        "long", max_examples=5000, deadline=None, suppress_health_check=list(HealthCheck)
    )
    settings.load_profile("quick")
