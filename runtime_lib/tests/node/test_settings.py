"""Private parameters: all that is wrong is reported at once, and nothing of them is used then."""

import pytest
from eddi_runtime.node.start import Settings, StartError, settings

CHOICES = {"on_loss": ("wait", "exit")}


def test_what_is_not_given_is_that_of_the_generated_node():
    good = settings({"frequency": 2, "other": object()}, 10.0, choices=CHOICES)
    assert good == Settings(2.0, words={"on_loss": "wait"})
    assert settings({}, 10.0, 3.0) == Settings(10.0, startup_grace=3.0)
    assert settings({"startup_grace": 0}, 10.0, 3.0) == Settings(10.0, startup_grace=0.0)


def test_all_that_is_wrong_is_told_at_once():
    bad = {"frequency": float("nan"), "diagnostics": 1, "watchdog_period": -1, "queue_size": 0}
    bad.update(startup_grace=-1, on_loss=[])
    with pytest.raises(StartError) as caught:
        settings({**bad, "frequency": "fast"}, 10.0, choices=CHOICES)
    wrong = str(caught.value).split("; p")
    wrong[1:] = [f"p{text}" for text in wrong[1:]]
    assert wrong[0] == "parameter ~frequency: 0.000001 to 1000000 Hz expected, got 'fast'"
    assert [text.split(":")[0] for text in wrong] == [f"parameter ~{name}" for name in bad]


@pytest.mark.parametrize("name", ["frequency", "watchdog_period", "startup_grace", "queue_size"])
@pytest.mark.parametrize("value", [True, None, "1", float("nan"), float("inf"), -1, [1]])
def test_what_is_no_number_is_refused(name, value):
    with pytest.raises(StartError, match=f"^parameter ~{name}: [^;]*$"):
        settings({name: value}, 10.0)


@pytest.mark.parametrize("value", [0, 0.0, 1e-7, 1e7, 1e300, 5e-324, 10**400])
def test_a_frequency_is_one_that_a_configuration_may_have(value):
    """At 1e300 Hz the first late step would end the loop: its overruns are no number."""
    with pytest.raises(StartError, match=r"^parameter ~frequency: [^;]*$"):
        settings({"frequency": value}, 10.0)
