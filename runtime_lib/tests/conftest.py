"""Hypothesis profiles, the same as in the generator's tests; Python 3.8 runs without hypothesis."""

try:
    from hypothesis import HealthCheck, settings
except ImportError:
    pass
else:
    settings.register_profile(
        "quick",
        max_examples=50,
        deadline=None,
        derandomize=True,
        suppress_health_check=list(HealthCheck),
    )
    settings.register_profile(
        "long", max_examples=5000, deadline=None, suppress_health_check=list(HealthCheck)
    )
    settings.load_profile("quick")
