"""Debouncing and majority, by the letters of their samples."""

from runtime_lib.tests.conserts import binary, give, monitor

RAW = {"T": True, "F": False, "U": None}


def made(*wanted):
    return monitor([("x", binary())], guarantees=["G"], edges=["x>G"], filtered=wanted)


def run(one, samples):
    found = []
    for sample in samples.split():
        one.execute_step(give(x=RAW[sample]))
        found.append(one.verdicts()["G"][0])
    return " ".join(found)


def test_debouncing_stands_in_the_reason():
    one = made("debounce", 4)
    run(one, "F T T")
    assert one.reasons()["x"] == ("debouncing", "debouncing, 2 of 4 good samples")
    assert one.explain("G").text() == (
        "G is FALSE, not active\n  needs x (debouncing, 2 of 4 good samples)"
    )
    assert one.blocked() == {}
    one = made("majority", 3)
    run(one, "F F T")
    assert one.reasons()["x"].text == "majority, 1 of 3 samples good"
