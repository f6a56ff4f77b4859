"""The monitor of a Bayesian network: inputs, methods, outputs, messages."""

import math
from types import SimpleNamespace

import pytest
from eddi_runtime import ModelError as RuntimeModelError
from eddi_runtime.bayesian_network import (
    BayesianNetworkMonitor,
    BayesianNetworkOutput,
    Node,
    Outcome,
)
from eddi_runtime.bayesian_network import outputs as out

from eddi_scaffold.kinds.bayesian_network.cross_check import posteriors
from runtime_lib.tests.bayesian_network.networks import (
    BINS,
    give,
    monitor,
    posterior,
)

DIRECT = {"Speed": "s", "Gap": "g", "Danger": "x"}
SLOW_NEAR = {"yes": 0.6, "no": 0.4}


def hostile():
    class Hostile:
        def __getattribute__(self, name):
            raise RuntimeError(name)

        def __eq__(self, other):
            raise RuntimeError

        __hash__ = None

        def __bool__(self):
            raise RuntimeError

    class Number(float):
        def __float__(self):
            raise RuntimeError

    return [Hostile(), Number("nan"), Number(2.0), 10**400, b"x", {}, [object()], type, ...]


def test_missing_inputs_leave_the_prior():
    one = monitor(bins=BINS)
    one.execute_step(give(v=2.0, d=None))
    assert one.status_message()[1]["unobserved"] == ["Gap"]
    assert one.status() == out.PARTIAL
    prior = posterior(one.execute_step(SimpleNamespace()))
    assert prior["yes"] == pytest.approx(0.2 * 0.025 + 0.5 * 0.225 + 0.3 * 0.3875, abs=1e-15)
    assert one.status() == out.PRIOR
    for value in (None, math.nan, object(), [], "no category"):
        assert posterior(one.execute_step(give(v=value, d=value))) == prior


@pytest.mark.parametrize("ways", [{"bins": BINS}, {"direct": DIRECT}])
def test_no_value_whatever_raises(ways):
    one = monitor(**ways)
    prior = one.execute_step(object())
    for value in hostile():
        x = SimpleNamespace(v=value, d=value, s=value, g=value, x=value)
        result = one.execute_step(x)
        if type(value).__name__ not in ("Number", "bytes"):  # a byte is its number
            assert result == prior
        one.message(result)
        one.faults()
        one.status_message()
    assert one.execute_step(hostile()[0]) == prior


def test_direct_inputs():
    one = monitor(direct=DIRECT, outputs=["Danger", "Alarm"])
    slow_near = pytest.approx(SLOW_NEAR, abs=1e-15)
    assert posterior(one.execute_step(give(s="slow", g="near"))) == slow_near
    assert posterior(one.execute_step(give(s=[0, 5, 0], g=(1.0, 0.0)))) == slow_near
    soft = posterior(one.execute_step(give(s="slow", g=[0.5, 1.0])))
    assert soft["yes"] == pytest.approx((0.125 * 0.6 + 0.75 * 0.1) / 0.875, abs=1e-15)
    echo = one.execute_step(give(x="no", s="fast", g="near"))
    assert posterior(echo) == {"yes": 0.0, "no": 1.0}
    assert posterior(echo, "Alarm") == {"on": 0.01, "off": 0.99}
    one.execute_step(give(s="hot", g=[1.0]))
    assert one.faults() == {"s": "there is no state 'hot'", "g": "1 values for 2 states"}


def test_impossible_evidence():
    given = give(s="stands", g="far", x="yes")
    good = give(s="slow", g="near")
    silent = monitor(direct=DIRECT, outputs=["Alarm"], explain=True)
    assert silent.execute_step(given) == []
    assert silent.status() == out.INCONSISTENT
    assert silent.as_json([]) is None
    assert silent.message([]) is None
    assert silent.series([]) == {"Alarm=on": None, "Alarm=off": None}
    (reason,) = silent.output_faults()
    assert reason == "the evidence has probability zero: Speed=stands, Gap=far, Danger=yes"
    assert silent.status_message()[1]["relevance"] == []
    silent.execute_step(good)
    assert silent.status() == out.PARTIAL
    prior = monitor(direct=DIRECT, outputs=["Alarm"], on_inconsistent="prior")
    assert prior.execute_step(given) == prior.execute_step(give())
    hold = monitor(direct=DIRECT, outputs=["Alarm"], on_inconsistent="hold")
    assert hold.execute_step(given) == []
    assert hold.execute_step(good) == hold.execute_step(given) != hold.execute_step(give())
    assert hold.execute_step(given) == hold.execute_step(give())
    hold.execute_step(good)
    hold.reset()
    assert hold.execute_step(given) == []
    assert hold.status() == out.INCONSISTENT


class Config:
    """As D7.2 generates it, with hand-written lines."""

    def __init__(self):
        self.dra_data = None
        self.calls = 0

    def update_dra_data(self, dra_data):
        self.dra_data = getattr(dra_data, "data", dra_data)

    def node_Speed(self):  # noqa: N802 - the name of the node stays
        is_bn_output = False
        outcome_stands = 0.0
        outcome_slow = 0.0
        outcome_fast = 0.0
        self.calls += 1
        if self.dra_data.v > 5.0:
            outcome_fast = 1.0
        return is_bn_output, {
            "stands": outcome_stands,
            "slow": outcome_slow,
            "fast": outcome_fast,
        }

    def node_Danger(self):  # noqa: N802 - the name of the node stays
        is_bn_output = False
        outcome_yes = 0.0
        outcome_no = 0.0
        is_bn_output = True
        return is_bn_output, {"yes": outcome_yes, "no": outcome_no}


def test_methods_of_a_person():
    hooks = Config()
    one = monitor(observed=["Speed"], hooks=hooks)
    fast = posterior(one.execute_step(give(v=6.0)))
    assert fast["yes"] == pytest.approx(0.25 * 0.95 + 0.75 * 0.2)
    assert one.status() == out.OK
    one.execute_step(give(v=1.0))
    assert (one.status(), hooks.calls) == (out.PRIOR, 2)


def test_a_method_that_raises():
    one = monitor(bins=BINS, hooks=Config())
    result = one.execute_step(give(v=None, d=1.0))
    assert posterior(result) == posterior(monitor(bins=BINS).execute_step(give(d=1.0)))
    assert one.status() == out.ERROR
    (reason,) = one.output_faults()
    assert reason.startswith("node_Speed raised TypeError: '>' not supported")
    one.execute_step(give(v=2.0, d=1.0))
    assert (one.status(), one.output_faults()) == (out.OK, ())

    class Unready(Config):
        def update_dra_data(self, dra_data):
            raise OSError

    late = monitor(bins=BINS, hooks=Unready())
    late.execute_step(give(v=2.0, d=1.0))
    assert late.output_faults() == ("update_dra_data raised OSError",)


class Made:
    """Methods whose source says nothing about what they set."""

    def __init__(self, **said):
        self.said = said

    def __getattr__(self, name):
        if name.startswith("node_") and name[5:] in self.said:
            return lambda: self.said[name[5:]]
        raise AttributeError(name)

    def update_dra_data(self, dra_data):
        pass


def test_methods_give_evidence_and_flag_outputs():
    hooks = Made(Alarm=(False, {"on": 0.0, "off": 0.0}))
    one = monitor(hooks=hooks, observed=["Alarm"], outputs=["Danger", "Gap"])
    one.execute_step(give())
    assert one.engine.observable == (3,)
    assert one.status() == out.PRIOR
    hooks.said["Alarm"] = (False, {"on": 1.0, "off": 0.0})
    assert posterior(one.execute_step(give()))["yes"] > 0.9
    assert one.status() == out.OK


@pytest.mark.parametrize(
    ("said", "reason"),
    [
        ((False, {"on": math.nan, "off": 0.0}), "on is nan, not a finite number from 0 on"),
        ((False, {"on": 1.0}), "there is no outcome for the state 'off'"),
        ((False, {"on": 1.0, "off": 0.0, "of": 0.0}), "there is no state of"),
        (None, "node_Alarm raised TypeError"),
    ],
)
def test_what_a_method_must_not_say(said, reason):
    one = monitor(hooks=Made(Alarm=said), observed=["Alarm"])
    assert posterior(one.execute_step(give())) == posterior(monitor().execute_step(give()))
    assert one.status() == out.ERROR
    assert reason in one.output_faults()[0]


def test_the_old_rule_of_evidence():
    hooks = Made(Alarm=(False, {"on": 0.7, "off": 0.3}))
    one = monitor(hooks=hooks, evidence_mode="d7.2", observed=["Alarm"])
    assert one.execute_step(give()) == monitor().execute_step(give())
    assert one.output_faults() == ("node_Alarm: evidence_mode d7.2 drops its outcomes",)
    hooks.said["Alarm"] = (False, {"on": 1.0, "off": 0.0})
    assert posterior(one.execute_step(give()))["yes"] > 0.9
    direct = monitor(direct=DIRECT, evidence_mode="d7.2")
    assert direct.execute_step(give(s=[0.5, 0.5, 0.0])) == direct.execute_step(give())


def test_without_inference_for_it_evidence_is_an_error_not_a_guess():
    hooks = Made(Alarm=(False, {"on": 0.0, "off": 0.0}))
    with pytest.raises(RuntimeModelError, match=r"set Alarm, but `observed:` .* upgrade`"):
        monitor(hooks=hooks)
    one = monitor(hooks=hooks, observed=["Alarm"])
    hooks.said["Alarm"] = (True, {"on": 1.0, "off": 0.0})
    assert one.execute_step(give()) == []
    assert one.status() == out.ERROR
    assert "`outputs:` of the configuration does not name it" in one.output_faults()[0]


@pytest.mark.parametrize(
    "spoilt",
    [
        3,
        [None],
        [BayesianNetworkOutput(0, "net", None)],
        [BayesianNetworkOutput(0, "net", [Node("Danger", [Outcome("yes", math.nan)])])],
        [BayesianNetworkOutput(0, "net", [Node("Danger", [Outcome("yes", True)])])],
        [BayesianNetworkOutput(0, "net", [Node(None, [])])],
    ],
)
def test_a_spoilt_output_is_not_published(spoilt):
    one = monitor(bins=BINS)
    assert one.message(spoilt) is None
    assert len(one.output_faults()) == 1


def test_relevance():
    one = monitor(bins=BINS, explain=True)
    one.execute_step(give(v=2.0, d=1.0))
    fields = one.status_message()[1]
    assert fields["relevance_nodes"] == ["Speed", "Gap"]
    assert fields["relevance"][1] == pytest.approx(0.6 - (0.25 * 0.6 + 0.75 * 0.1))


def test_posteriors_of_former_states_are_remembered(monkeypatch):
    monkeypatch.setattr(BayesianNetworkMonitor, "remembered", 4)
    one, never = monitor(direct=DIRECT), monitor(direct=DIRECT)
    never.remembered = 0
    cases = [give(s=s, g=g) for s in ("stands", "slow", "fast", None) for g in ("near", "far")]
    for _ in range(2):
        for case in cases:
            assert one.execute_step(case) == never.execute_step(case)
    assert (len(one._known_rows), len(never._known_rows)) == (4, 0)
    impossible = give(s="stands", g="far", x="yes")
    fresh = monitor(direct=DIRECT, outputs=["Alarm"])
    assert fresh.execute_step(impossible) == fresh.execute_step(impossible) == []


def test_posteriors_by_name():
    one = monitor(direct=DIRECT)
    found = posteriors(one, {"Speed": "slow", "Gap": [1.0, 0.0]})
    assert found == {"Danger": (0.6, 0.4)}
    impossible = {"Speed": "stands", "Gap": "far", "Danger": "yes"}
    assert posteriors(monitor(direct={**DIRECT, "Danger": "x"}), impossible) is None


class Odd(Config):
    """Methods that might change what they say, although they read no name."""

    def node_Gap(self):  # noqa: N802 - the name of the node stays
        return False, {"near": 1.0 if self else 0.0, "far": 0.0}

    def node_Alarm(self, seen=[1.0]):  # noqa: B006, N802 - on purpose
        on = seen[0]
        seen[0] = 0.0
        return False, {"on": on, "off": 0.0}

    def node_Danger(self):  # noqa: N802 - the name of the node stays
        return self == 3, {"yes": 0.0, "no": 0.0}


def test_a_method_that_can_read_its_object_or_a_default_is_asked_in_each_step():
    one = monitor(bins=BINS, hooks=Odd(), observed=["Danger", "Alarm"])
    assert len(one._methods._asked) == 4
    one.execute_step(give(v=2.0, d=3.0))
    assert "Alarm" not in one.status_message()[1]["unobserved"]
    one.execute_step(give(v=2.0, d=3.0))
    assert "Alarm" in one.status_message()[1]["unobserved"]
