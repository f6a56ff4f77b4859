"""Minimal missing sets, losses, their order and their reasons."""

from eddi_runtime import EDDIInputBase

from runtime_lib.tests.conserts import GOOD, give, monitor, nested


def test_text():
    made = nested()
    made.execute_step(give(a=False, c="high", n=12, d=None))
    assert made.explain("G").text() == (
        "G is UNKNOWN, not active\n"
        "  needs d (no value)\n"
        "  needs a (the value is False) and c (the value 'high' is not in {low})"
        " and n (the value 12 is not in [0, 10] or [20, 30) m)\n"
        "  needs b (no value) and c (the value 'high' is not in {low})"
        " and n (the value 12 is not in [0, 10] or [20, 30) m)"
    )
    made.execute_step(give(a=True, c="low", n=3.0))
    assert made.explain("G").text() == "G is active; its loss would end it: a, c, n"
    made.execute_step(give(**GOOD))
    assert made.explain("G").text() == "G is active; its loss would end it: no single input"


def test_reasons_of_an_input_object():
    class Input(EDDIInputBase):
        def __init__(self):
            super().__init__()
            self.d = None

        def process(self, message):
            self.d = message

    made, source = nested(), Input()
    source.bind([spec._replace(max_age=0.5) for spec in made.inputs])
    source.update("d", source.process, {"topic": None}, ("topic",))
    made.execute_step(source)
    assert made.reasons()["d"] == ("missing", "no message of topic")
    source.begin_step({"topic": 2.0})
    source.update("d", source.process, {"topic": True}, ("topic",))
    made.execute_step(source)
    assert made.reasons()["d"] == ("stale", "the last message is 2 s old, the limit is 0.5 s")
    source.begin_step({"topic": 0.1})
    source.update("d", source.process, {"topic": "yes"}, ("topic",))
    made.execute_step(source)
    assert made.reasons()["d"].kind == "fault"


def test_the_cap_keeps_the_smallest_sets_and_says_so():
    leaves = [f"e{i}_{j}" for i in range(6) for j in range(6)]
    made = monitor(
        leaves,
        gates=[f"o{i}|" for i in range(6)],
        guarantees=["G"],
        edges=[f"e{i}_{j}>o{i}" for i in range(6) for j in range(6)]
        + [f"o{i}>G" for i in range(6)],
    )
    made.execute_step(give())
    found = made.explain("G")
    assert found.truncated
    assert len(found.missing) == 256
    assert found.missing[0] == tuple(f"e{i}_0" for i in range(6))
    assert found.text().endswith("\n  ... and more")
    assert made.status_message()[1]["guarantees"][0][1]["missing"] == list(found.missing[0])
