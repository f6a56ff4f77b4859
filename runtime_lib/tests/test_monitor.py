"""Evaluation, output, best guarantees, messages and what stands beside the output."""

import numpy as np
import pytest
from eddi_runtime import EDDIInputBase
from eddi_runtime.inputs import InputSpec, accepted

from runtime_lib.tests.conserts import GOOD, active, binary, give, monitor, nested


def test_the_output_is_a_new_list_of_dicts_in_file_order():
    made = monitor(["e", "f"], guarantees=["Z", "A"], edges=["e>Z", "f>A"])
    rows = made.execute_step(give(e=True, f=None))
    assert rows == [{"id": "Z", "active": True}, {"id": "A", "active": False}]
    assert rows[1]["active"] is False
    rows[0]["active"] = None
    assert made.execute_step(give(e=True, f=None)) == [
        {"id": "Z", "active": True},
        {"id": "A", "active": False},
    ]
    assert made.step(give(e=1, f=True)) == (False, True)


def test_a_property_that_raises_is_a_fault_of_that_input_only():
    class Source:
        d = True

        @property
        def a(self):
            raise ZeroDivisionError

        def __getattr__(self, name):
            raise ValueError(name)

    made = nested()
    assert active(made.execute_step(Source())) == ["G"]
    assert made.faults()["a"] == "reading it raised ZeroDivisionError"
    assert made.faults()["b"] == "reading it raised ValueError"
    assert set(made.faults()) == {"a", "b", "c", "n"}


def test_interrupts_are_not_swallowed():
    class Source:
        @property
        def a(self):
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        nested().execute_step(Source())


def test_class_ids_are_published_and_model_ids_explained():
    made = monitor(["e"], guarantees=["g_1"], edges=["e>g_1"], guarantee_ids="class")
    assert made.execute_step(give()) == [{"id": "G1", "active": False}]
    assert made.verdicts() == {"g_1": "UNKNOWN"}
    assert made.explain("g_1") == made.explain("G1") == made.explain()[0]
    with pytest.raises(LookupError, match="there is no guarantee 'x'; there: g_1"):
        made.explain("x")


def test_best_guarantees():
    made = monitor(
        ["e", "f"],
        guarantees=[
            {"id": "D", "default": True, "ranking": 0},
            "N1",
            "N2",
            {"id": "R2", "ranking": 2},
            {"id": "R1", "ranking": 1},
        ],
        edges=["e>N1", "e>N2", "e>R2", "f>R1"],
        services=[("S", ["R2", "R1", "N2", "N1", "D"]), ("T", ["N2", "N1"]), ("U", ["D", "N1"])],
    )
    made.execute_step(give())
    assert made.best_guarantees() == {"S": "D", "T": None, "U": "D"}
    made.execute_step(give(e=True))
    assert made.best_guarantees() == {"S": "R2", "T": "N1", "U": "N1"}
    made.execute_step(give(e=True, f=True))
    assert made.best_guarantees()["S"] == "R1"


def test_message_takes_nothing_but_bools_as_active():
    made = monitor(["e"], guarantees=["G"], edges=["e>G"])
    rows = made.execute_step(give(e=True))
    assert made.message(rows) == (
        "ConSertOutput",
        {"guarantees": [("Guarantee", {"id": "G", "active": True})]},
    )
    assert made.output_faults() == ()
    for spoilt in (2, "True", None, float("nan"), [1]):
        tree = made.message([{"id": "G", "active": spoilt}])
        assert tree[1]["guarantees"] == [("Guarantee", {"id": "G", "active": False})]
        assert made.output_faults() == ("'active' of 'G' is not a bool; published as not active",)
    assert made.message(None)[1]["guarantees"] == [("Guarantee", {"id": "G", "active": False})]
    assert made.message([None, {"id": 3, "active": True}])[1] == {"guarantees": []}
    assert len(made.output_faults()) == 2
    ((_, row),) = made.message([{"id": "G", "active": np.bool_(True)}])[1]["guarantees"]
    assert row["active"] is True


def test_unsupported_elements_are_constants_when_asked_for():
    made = monitor(
        gates=["and&", "or|"],
        guarantees=["Alone", "A", "O"],
        edges=["and>A", "or>O"],
    )
    assert active(made.execute_step(None)) == ["Alone", "A"]
    assert made.explain("O").missing == ()
    assert made.explain("O").text() == "O is FALSE, not active\n  nothing can activate it"


def test_a_ladder_of_shared_gates_is_linear():
    made = monitor(*ladder(300))
    given = give(**{f"e{k}": True for k in range(602)})
    assert made.step(given) == (True, True)
    assert made.step(give()) == (False, False)
    assert all(explanation.truncated for explanation in made.explain())


def ladder(levels):
    gates, edges, pair = [], [], ("e0", "e1")
    for k in range(levels):
        gates += [f"a{k}&", f"o{k}|"]
        for gate, leaf in ((f"a{k}", f"e{2 * k + 2}"), (f"o{k}", f"e{2 * k + 3}")):
            edges += [f"{pair[0]}>{gate}", f"{pair[1]}>{gate}", f"{leaf}>{gate}"]
        pair = f"a{k}", f"o{k}"
    edges += [f"{pair[0]}>G", f"{pair[1]}>H"]
    return [f"e{k}" for k in range(2 * levels + 2)], [], gates, ["G", "H"], edges


@pytest.mark.slow
def test_a_chain_of_5_000_gates():
    count = 5_000
    gates = [f"g{k}&" for k in range(count)]
    edges = [f"g{k}>g{k + 1}" for k in range(count - 1)]
    edges += ["e>g0", "f>g2500", "h>g0", f"g{count - 1}>G"]
    edges += [f"f>g{k}" for k in range(0, count, 2) if k != 2500]
    made = monitor(["e", "f", "h"], gates=gates, guarantees=["G"], edges=edges)
    assert made.step(give(e=True, f=True, h=True)) == (True,)
    assert made.explain("G").single_losses == ("e", "f", "h")
    made.step(give(e=True))
    assert made.explain("G").missing == (("f", "h"),)


def test_no_guarantees():
    assert monitor(["e"]).execute_step(give()) == []


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
    assert one.explain("G").text() == (
        "G is FALSE, not active\n  needs x (debouncing, 2 of 4 good samples)"
    )
    one = made("majority", 3)
    run(one, "F F T")
    assert one.explain("G").reasons["x"] == "majority, 1 of 3 samples good"


def test_text():
    made = nested()
    made.execute_step(give(a=False, c="high", n=12, d=None))
    assert made.explain("G").text() == (
        "G is UNKNOWN, not active\n"
        "  needs d (no value)\n"
        "  needs a (false for 0.0 s) and c (high for 0.0 s, needs low)"
        " and n (12 m for 0.0 s, needs 0 .. 10 or 20 ..< 30 m)\n"
        "  needs b (no value) and c (high for 0.0 s, needs low)"
        " and n (12 m for 0.0 s, needs 0 .. 10 or 20 ..< 30 m)"
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

    made = nested(specs={"d": {"max_age": 0.5, "requires": ["topic"]}})
    source = Input()
    source.bind(made.inputs)
    source.update("d", source.process, {"topic": None}, ("topic",))
    made.execute_step(source)
    assert made.explain("G").reasons["d"] == "no message yet, 0.0 s after the start"
    source.begin_step({"topic": 2.0})
    source.update("d", source.process, {"topic": True}, ("topic",))
    made.execute_step(source)
    assert made.explain("G").reasons["d"] == "nothing for 2.0 s, limit 0.5 s"
    source.begin_step({"topic": 0.1})
    source.update("d", source.process, {"topic": "yes"}, ("topic",))
    made.execute_step(source)
    assert made.explain("G").reasons["d"] == "expected True or False, got 'yes'"


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


def test_what_is_not_known_comes_before_what_is_false():
    made = monitor(["a", "z"], gates=["or1|"], guarantees=["G"], edges=["a>or1", "z>or1", "or1>G"])
    made.execute_step(give(a=False, z=None))
    assert made.why()["G"].sentence == "G <- z: no value"
    made.execute_step(give(a=False, z=False))
    assert made.why()["G"].sentence == "G <- a: false for 0.0 s"


class Input(EDDIInputBase):
    def __init__(self, specs):
        super().__init__()
        self.e = None
        self.bind(specs)

    def process_e(self, message):
        self.e = message

    def give(self, message, age=0.0):
        self.begin_step({"e": age})
        self.update("e", self.process_e, {} if message is None else {"e": message}, ["e"])
        return self


def test_an_input_without_limit_is_an_acceptance_as_long_as_it_has_a_value():
    made = monitor(
        ["e"], guarantees=["G"], edges=["e>G"], specs={"e": {"max_age": "none", "requires": ["e"]}}
    )
    told = Input(made.inputs)
    made.execute_step(told.give(None))
    assert made.accepted() == ()
    made.execute_step(told.give(True, age=1e6))
    assert made.accepted() == ("e: max_age: none",)
    assert made.status_message()[1]["accepted"] == ["e: max_age: none"]
    made.execute_step(give(e=True))  # nobody watches the messages
    assert made.accepted() == ()


def test_a_majority_is_in_use_while_it_outvotes_the_present_sample():
    made = monitor(["e"], guarantees=["G"], edges=["e>G"], filtered=("majority", 3))
    for value, holds, used in (
        (True, True, ()),
        (True, True, ()),
        (None, True, ("e: filter: majority",)),
        (None, False, ()),
    ):
        rows = made.execute_step(give(e=value))
        assert (rows[0]["active"], made.accepted()) == (holds, used)


class Hostile:
    def __getattr__(self, name):
        raise RuntimeError(name)


def test_a_hostile_object_accepts_nothing():
    assert accepted((InputSpec("e", "e", max_age="none"),), Hostile()) == ()
