"""Every guarantee, active or not, with what it lacks; and which acceptances are in use."""

from eddi_runtime import EDDIInputBase
from eddi_runtime.inputs import InputSpec, accepted

from runtime_lib.tests.conserts import give, monitor


def test_what_is_not_known_comes_before_what_is_false():
    made = monitor(["a", "z"], gates=["or1|"], guarantees=["G"], edges=["a>or1", "z>or1", "or1>G"])
    made.execute_step(give(a=False, z=None))
    assert made.standings()[0].lacks == (("z", "no value"),)
    made.execute_step(give(a=False, z=False))
    assert made.standings()[0].lacks == (("a", "the value is False"),)


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
    for value, active, used in (
        (True, True, ()),
        (True, True, ()),
        (None, True, ("e: filter: majority",)),
        (None, False, ()),
    ):
        rows = made.execute_step(give(e=value))
        assert (rows[0]["active"], made.accepted()) == (active, used)


class Hostile:
    def __getattr__(self, name):
        raise RuntimeError(name)


def test_a_hostile_object_accepts_nothing():
    assert accepted((InputSpec("e", "e", max_age="none"),), Hostile()) == ()
