"""Why claims do not hold: what recordings of the oracle do not show."""

import math
from types import SimpleNamespace

import pytest
from eddi_runtime import InputSpec
from eddi_runtime.inputs import UNDECIDED, UNKNOWN_AGE, EDDIInputBase, InputState, Word
from eddi_runtime.why import FALSE, UNKNOWN, Cause, ClaimWhy

from runtime_lib.tests.bayesian_network import test_claims as networks
from runtime_lib.tests.bayesian_network.networks import node, threshold
from runtime_lib.tests.conserts import binary, categorical, give, monitor, numeric, one_leaf
from runtime_lib.tests.event import event_models
from runtime_lib.tests.reliability import test_reliability_monitor as reliability
from runtime_lib.tests.reliability.reliability_models import chain
from runtime_lib.tests.reliability.reliability_models import monitor as reliable
from runtime_lib.tests.safeml import monitors as safeml

SECOND = 1_000_000_000
NAN = math.nan
SPEC = InputSpec("x", "x", ("a",), 0.5)
TOPICS = {"a": "/a", "b": "/b"}


def told(process=None, *, spec=SPEC, steps=((0, {}),), look=None, ages=None, words=None):
    """Return what an input object tells of an input after steps: (second, messages)."""
    given = EDDIInputBase((spec,))
    process = process or (lambda *messages: setattr(given, "x", messages[0]))
    for second, messages in steps:
        given.begin_step(ages, t_ns=second * SECOND, words=words)
        given.update("x", process, messages, spec.requires)
    if look is not None:
        given.look_again(round(look * SECOND))
    return [cause.chain for cause in given.why(spec, UNKNOWN, 7.0, TOPICS)]


def process_x(*messages):
    raise KeyError(messages)


LINE = process_x.__code__.co_firstlineno + 1


@pytest.mark.parametrize(
    ("how", "chain_"),
    [
        ({"steps": ((0, {}), (3, {}))}, "/a: no message yet, 3.0 s after the start"),
        ({"steps": ((9, {}), (1, {}), (3, {}))}, "/a: no message yet, 2.0 s after the start"),
        ({"steps": ((0, {"a": 1}),), "look": 2.0}, "/a: nothing for 2.0 s, limit 0.5 s"),
        ({"steps": ((0, {"a": 1}),), "ages": {"a": 9.5}}, "/a: nothing for 9.5 s, limit 0.5 s"),
        (
            {"steps": ((0, {"a": 1}),), "ages": {"a": UNKNOWN_AGE}},
            "/a: latched, its age is not known",
        ),
        ({"steps": ((0, {"a": 1}), (-5, {"a": 1}))}, "/a: two clocks"),
        (
            {"process": process_x, "steps": ((0, {"a": 1}),)},
            f"/a: process_x raised KeyError in test_whys.py line {LINE}",
        ),
        (
            {"process": lambda *_: int("?"), "steps": ((0, {"a": 1}),)},
            "/a: ValueError: invalid literal for int() with base 10: '?'",
        ),
        ({"process": print, "steps": ((0, {"a": 1}),)}, "/a: process_x assigned nothing"),
    ],
)
def test_an_input_tells_what_its_messages_lack(how, chain_, capsys):
    assert told(**how) == [chain_]


def test_of_several_topics_those_that_lack_something_are_named():
    spec = InputSpec("x", "x", ("a", "b"), 0.5)
    messages = {"a": 1, "b": 2}
    late = told(spec=spec, steps=((0, messages), (1, {"a": 3, "b": 2})), look=1.0)
    assert late == ["/b: nothing for 1.0 s, limit 0.5 s"]
    assert told(spec=spec, steps=((0, {"a": 1}),)) == ["/b: no message yet, 0.0 s after the start"]
    assert len(told(spec=spec, steps=((0, messages),), look=9.0)) == 2


def test_words_of_robots():
    spec = SPEC._replace(claims=(("a", "G"),))
    silent = Word("b", "the word of b may be 1.2 s old", 1.2, 1.0)
    assert told(spec=spec, words={"a": silent}) == ["b/G: robot b silent 1.2 s, lease 1 s"]
    assert told(spec=spec, words={"a": Word("", "no word")}) == ["G: no word"]
    other = Word("b", "b has another model", 0.2, 1.0)
    assert told(spec=spec, words={"a": other}) == ["b/G: b has another model"]
    known = {"steps": ((0, {"a": give(id="G", active=False)}),), "words": {"a": Word("b")}}
    assert told(spec=spec, **known) == ["b/G: unknown there, its monitor tells no reason"]


def test_what_began_by_a_clock_that_went_back_is_as_old_as_that():
    one = one_leaf(binary(), requires=("a",))
    given = EDDIInputBase(one.inputs)
    for second in (9, 10, 3, 5):
        given.begin_step({}, t_ns=second * SECOND)
        given.update("x", lambda _: setattr(given, "x", False), {"a": 1}, ("a",))
        one.execute_step(given, second * SECOND)
    assert sentences(one)["G"] == "G <- x: false for 2.0 s"
    one.execute_step(give(x=False), 6 * SECOND)
    assert sentences(one)["G"] == "G <- x: false for an unknown time"


def test_states_that_only_expressions_have():
    given = EDDIInputBase((SPEC,))
    given.states["x"] = InputState("invalid", UNDECIDED)
    (cause,) = given.why(SPEC, UNKNOWN, 0.0, TOPICS)
    assert (cause.path, cause.state) == ((), "window")
    assert given.known_for((SPEC,)) == 0.0
    assert given.known_for(()) == math.inf


@pytest.mark.parametrize("rows", ["guarantees", "in_state"])
def test_claims_of_other_monitors(rows):
    spec = SPEC._replace(claims=(("a", "x"), ("b", "G")))
    given = EDDIInputBase((spec,))
    there = Cause(("in",), "window", "fills", monitors=("m",))
    why = {"x": ClaimWhy("x", UNKNOWN, (there,)), "G": ClaimWhy("G", UNKNOWN, (there,))}
    holds = give(**{rows: [give(id="x", active=True), give(id="G", active=False)]})
    given.begin_step({}, t_ns=0)
    given.update("x", lambda _: None, {"a": holds, "a/why": why, "b/why": why}, ("a",))
    given.states["x"] = InputState("ok")
    paths = [cause.path for cause in given.why(spec, UNKNOWN, 0.0, TOPICS)]
    assert paths == [("in",), ("G", "in")]  # one that has the id of the input is one link
    texts = [cause.chain for cause in given.why(spec, FALSE, 3.0, TOPICS)]
    assert texts == ["true for 3.0 s"]  # it is read as NOT
    assert given.why(spec._replace(requires=("a", "c")), FALSE, 3.0, TOPICS) == []
    given.states["x"] = InputState("untold")
    (cause,) = given.why(SPEC, UNKNOWN, 3.0, TOPICS)
    assert cause.chain == "/a: unknown there, its monitor tells no reason"


def sentences(one):
    return {id_: why.sentence for id_, why in one.why().items()}


def test_values_of_a_consert():
    evidence = ["a", ("b", binary(good=False)), ("c", categorical("low", "ok"))]
    evidence += [("n", numeric("[0, 10]", "[20, 30)", uom="percent"))]
    names = [name if isinstance(name, str) else name[0] for name in evidence]
    one = monitor(
        evidence,
        guarantees=[f"G{name}" for name in names],
        edges=[f"{name}>G{name}" for name in names],
    )
    one.execute_step(give(a=False, b=True, c="fog", n=10**400), 0)
    one.execute_step(give(a=False, b=True, c="fog", n=12.0), 2 * SECOND)
    assert sentences(one) == {
        "Ga": "Ga <- a: false for 2.0 s",
        "Gb": "Gb <- b: true for 2.0 s",
        "Gc": "Gc <- c: fog for 2.0 s, needs low or ok",
        "Gn": "Gn <- n: 12 % for 2.0 s, needs 0 .. 10 or 20 ..< 30 %",
    }
    one.execute_step(give(a=1, b=False, c="low", n=NAN), 3 * SECOND)
    assert sentences(one) == {
        "Ga": "Ga <- a: expected True or False, got 1", "Gb": "", "Gc": "", "Gn": "Gn <- n: NaN",
    }  # fmt: skip
    one.execute_step(give(n=10**400), "no time")
    assert sentences(one)["Gn"] == (
        "Gn <- n: a number that is too large for 0.0 s, needs 0 .. 10 or 20 ..< 30 %"
    )
    assert sentences(one)["Ga"] == "Ga <- a: no value"


def test_a_filter_waits():
    one = monitor(["x"], guarantees=["G"], edges=["x>G"], filtered=["debounce", 3])
    one.execute_step(give(x=True), 0)
    assert sentences(one)["G"] == "G <- x: debouncing, 1 of 3 good samples"


def test_an_event_tells_what_its_inputs_hold():
    one = event_models.monitor(("gt", "x", 5), "a")
    one.execute_step(SimpleNamespace(x=4.0, a=True), 0)
    one.execute_step(SimpleNamespace(x=3.0, a=True), 2 * SECOND)
    assert sentences(one)["e0"] == "e0: false for 2.0 s (x 4)"
    one.execute_step(SimpleNamespace(x=NAN, a="?"), 3 * SECOND)
    assert sentences(one)["e0"] == "e0 <- x: NaN"
    one.execute_step(SimpleNamespace(), 4 * SECOND)
    assert sentences(one)["e0"] == "e0 <- x: no value"


@pytest.mark.parametrize("broken", [property(lambda _: 1 / 0), None])
def test_whatever_breaks_there_is_no_reason_and_no_exception(broken):
    one = event_models.monitor(("gt", "x", 5))
    type(one)._whys, before = broken, type(one)._whys
    try:
        assert one.why() == {}
    finally:
        type(one)._whys = before


def test_thresholds_of_a_network():
    one = networks.risk()
    networks.step(one)
    bounds = "(Risk=High 0.05 .. 0.9, limit 0.3)"
    assert sentences(one)["Low"] == (f"Low <- near: no value {bounds}; human: no value {bounds}")
    networks.step(one, 2.0, near="yes", human="yes")
    networks.step(one, 5.0, near="yes")
    assert sentences(one)["Low"] == "Low: Risk=High 0.4 for 3.0 s, limit 0.3"
    networks.step(one, 6.0, near="no")
    assert sentences(one)["Low"] == ""
    one = networks.risk(threshold(at_least=0.95))
    networks.step(one, near="yes", human="yes")
    assert sentences(one)["Low"] == "Low: Risk=High 0.9 for 0.0 s, limit 0.95"
    one = networks.risk(threshold(at_most=0.3, release=0.5))
    networks.step(one, near="yes", human="no")
    assert sentences(one)["Low"] == "Low: Risk=High 0.4, limit 0.3"
    one = networks.risk(direct={"Human": "human"}, bins={"Near": networks.BAND})
    networks.step(one, d=1.8, human="no")
    (cause,) = one.why()["Low"].causes
    assert (cause.path, cause.text) == (("Near",), "may be yes or no after a gap")
    one = networks.risk(
        threshold(at_most=0.1), direct={"Near": "near"}, observed=["Human"], hooks=networks.Made()
    )
    networks.step(one, near="no")
    bounds = "(Risk=High 0.05 .. 0.2, limit 0.1)"
    assert sentences(one)["Low"] == f"Low <- Human: not observed {bounds}"


def test_what_keeps_a_network_from_an_answer():
    never = node("Near", "yes no", (), [0.0, 1.0])
    one = networks.risk(nodes=(never, networks.HUMAN, networks.RISK))
    networks.step(one, near="yes", human="no")
    assert sentences(one)["Low"] == "Low: the evidence has probability zero"


def test_thresholds_of_a_reliability_model():
    unseen = [[0, "ok", False], [1, "ok", True]]
    limits = [{"id": "T", "activate": 1e-3, "release": 2e-3, "hold": 0.0}]
    one = reliable(
        [chain([[0, 1, 1e-5], [1, 2, 1e-3]], 3, [2], observe=unseen)], ["ok"], thresholds=limits
    )
    for at, ok in ((0.0, True), (0.5, None)):
        reliability.step(one, at, ok=ok)
    (cause,) = one.why()["T"].causes
    assert (cause.path, cause.text, cause.detail[:6]) == (("ok",), "no value", "p_fail")
    reliability.step(one, 1.0, ok=True)
    assert sentences(one)["T"].startswith("T: p_fail 1, limit 0.001 (chain: ok was missing")
    reliability.step(one, 0.0, ok=True)
    assert "the clock went back" in sentences(one)["T"]


def test_a_scope_tells_of_bad_samples():
    one = safeml.monitor([[k / 10] for k in range(10)])
    safeml.step(one, [NAN])
    assert sentences(one)["in_scope"].startswith("in_scope <- sample: ")
    safeml.step(one, [0.5])
    assert sentences(one)["in_scope"] == "in_scope: window has 1 of 4 samples"
