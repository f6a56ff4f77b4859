"""Thresholds of posteriors: active only if they hold for every state of what is unknown."""

import math

import pytest
from eddi_runtime.bayesian_network.claims import COMBINATIONS

from .networks import HUMAN, RISK, RISKS, give, monitor, node, posterior, threshold

SECOND = 1_000_000_000
DIRECT = {"Near": "near", "Human": "human"}
BAND = {"input": "d", "bins": [2.0], "hysteresis": 0.5}
AS_TEXT = {"map": [["yes", "yes"], ["no", "no"]]}
LOW = threshold(at_most=0.3)


def risk(*thresholds, nodes=RISKS, direct=DIRECT, **more):
    return monitor(nodes, ("Risk",), direct=direct, thresholds=list(thresholds or (LOW,)), **more)


def step(one, t=0.0, **values):
    one.execute_step(give(**values), int(t * SECOND))
    (claim, *_) = one.claims()
    return claim


def test_a_reason_says_what_keeps_it_from_being_active():
    one = risk()
    assert step(one).reason == "unknown inputs"
    assert step(one, near="yes").reason == ""  # whoever is there, it is too much
    assert step(one, near="no").reason == ""
    assert one.facts().unknown_inputs == ("human",)


def test_the_prior_speaks_only_by_name():
    bins = {"Human": {"input": "human", **AS_TEXT}}
    claims = [
        step(risk(direct={"Near": "near"}, bins={"Human": {**bins["Human"], **policy}}), near="no")
        for policy in ({}, {"missing": "unobserved"}, {"missing": "prior"})
    ]
    assert [claim.high for claim in claims] == pytest.approx([0.2, 0.2, 0.08])


@pytest.mark.parametrize(
    ("policy", "default", "high"), [("prior", None, 0.08), ("default", "no", 0.05)]
)
def test_what_is_accepted_is_named_while_it_is_needed(policy, default, high):
    bins = {"Human": {"input": "human", "missing": policy, **AS_TEXT}}
    specs = {"human": {"default": default}}
    one = risk(direct={"Near": "near"}, bins=bins, specs=specs)
    assert step(one, near="no", human="yes").high == pytest.approx(0.2)
    assert (one.facts().valid, one.facts().accepted) == (True, ())
    for value in (None, math.nan, "garbage"):
        assert step(one, near="no", human=value).high == pytest.approx(high)
        facts = one.facts()
        assert (facts.unknown_inputs, facts.accepted) == (
            ("human",),
            (f"human: missing: {policy}",),
        )
        assert not facts.valid
    assert step(one, human="no").high == pytest.approx(0.4)  # Near is not accepted


def test_what_is_held_is_accepted_for_a_while():
    bins = {"Human": {"input": "human", "missing": "hold", **AS_TEXT}}
    specs = {"human": {"max_age": 0.7}}
    one = risk(direct={"Near": "near"}, bins=bins, specs=specs)
    step(one, 0.0, near="no", human="no")
    assert step(one, 0.5, near="no").high == pytest.approx(0.05)
    assert one.facts().accepted == ("human: missing: hold",)
    assert step(one, 1.0, near="no").high == pytest.approx(0.2)
    assert one.facts().accepted == ()


def test_clamped_and_infinite_values_are_accepted_by_name():
    near = {"input": "d", "bins": [2.0], "range": [0, 9], "out_of_range": "clamp"}
    one = risk(direct={}, bins={"Near": {**near, "allow_inf": True}})
    clamp, infinite = ("d: out_of_range: clamp",), ("d: allow_inf: true",)
    for value, accepted in ((5.0, ()), (10.0, clamp), (5, ()), (math.inf, infinite), (5.0, ())):
        assert step(one, d=value).high == pytest.approx(0.08)
        assert (one.facts().valid, one.facts().accepted) == (True, accepted)


def test_a_value_within_the_hysteresis_after_a_gap_leaves_two_states():
    one = risk(direct={"Human": "human"}, bins={"Near": BAND})
    assert step(one, d=1.8, human="no").high == pytest.approx(0.4)  # the start is a gap
    assert one.facts().undecided == {"Near": ("yes", "no")}
    assert not one.facts().valid
    output = one.execute_step(give(d=2.6, human="no"))
    assert (one.claims()[0].high, one.facts().valid) == (pytest.approx(0.05), True)
    assert posterior(output, "Risk")["High"] == pytest.approx(0.05)
    assert step(one, d=1.8, human="no").high == pytest.approx(0.05)  # kept, without a doubt
    step(one, human="no")
    one.execute_step(give(d=2.3, human="no"))
    assert one.facts().undecided == {"Near": ("no", "yes")}
    assert step(one, d=2.4, human="no").high == pytest.approx(0.4)  # still not known
    assert step(one, d=1.4, human="no").low == pytest.approx(0.4)
    assert one.status_message()[1]["undecided"] == []


def test_a_special_value_is_no_gap():
    order = {"order": ["yes", "no"], "sentinel": [[-1, "no"], [-2, "unobserved"]]}
    one = risk(direct={"Human": "human"}, bins={"Near": {**BAND, **order}})
    step(one, d=-1, human="no")
    assert step(one, d=1.8, human="no").high == pytest.approx(0.4)
    assert one.facts().undecided == {}
    step(one, d=-2, human="no")
    step(one, d=1.8, human="no")
    assert list(one.facts().undecided) == ["Near"]


@pytest.mark.parametrize("policy", ["prior", "hold"])
def test_nothing_is_claimed_of_evidence_that_cannot_be(policy):
    never = node("Near", "yes no", (), [0.0, 1.0])
    one = risk(nodes=(never, HUMAN, RISK), on_inconsistent=policy)
    assert step(one, near="no", human="no").active
    output = one.execute_step(give(near="yes", human="no"))
    assert output  # the posterior is accepted without its evidence
    assert not one.claims()[0].active
    assert one.facts().accepted == (f"on_inconsistent: {policy}",)
    assert not one.facts().valid


def test_likelihoods_are_known():
    one = risk()
    claim = step(one, near="no", human=[1.0, 3.0])
    assert claim.high == pytest.approx((0.2 * 0.2 + 0.05 * 3 * 0.8) / (0.2 + 3 * 0.8))
    assert (step(one, human=[1.0, 3.0]).low, one.claims()[0].high) == pytest.approx(
        (0.0615, 0.438), abs=1e-3
    )


def test_a_clock_that_goes_back_lets_the_time_begin_anew():
    one = risk(threshold(at_most=0.3, hold_s=1.0))
    times = (5.0, 0.0, 0.5, 1.0)
    assert [step(one, t, near="no").active for t in times] == [False, False, False, True]
    one.reset()
    one.execute_step(give(near="no"), 0.5)
    assert one.claims()[0].reason == "no time"


def test_a_node_need_be_no_output():
    one = monitor(RISKS, ("Human",), direct={"Near": "near"}, thresholds=[LOW])
    output = one.execute_step(give(near="no"))
    assert [found.title for found in output[0].output_nodes] == ["Human"]
    assert list(one.series(output)) == ["Human=yes", "Human=no", "Low"]
    assert one.series(output)["Low"] is True


def test_too_many_combinations_are_not_tried():
    names = [f"n{k}" for k in range(11)]
    nodes = [node(name, "y n", (), [0.5, 0.5]) for name in names]
    rows = [0.25, 0.75] + [0.125, 0.875] * 7
    nodes.append(node("Risk", "High Low", names[:3], rows))
    one = monitor(nodes, ("Risk",), direct={n: n for n in names}, thresholds=[LOW])
    assert step(one).reason == "too many unknown inputs"
    assert step(one, n10="y").active  # 2^10
    assert COMBINATIONS == 1024


def test_an_input_that_is_unknown_is_named_where_it_decides():
    one = risk(LOW, threshold("Some", at_most=0.06), threshold("Never", at_most=0.01))
    step(one, near="no")
    named = {id_: [cause.path for cause in why.causes] for id_, why in one.why().items()}
    assert named == {"Low": [], "Some": [("human",)], "Never": [()]}


class Made:
    def __init__(self):
        self.said = {}

    def update_dra_data(self, data):
        pass

    def node_Human(self):  # noqa: N802 - the name of the node stays
        outcome_yes = 0.0
        outcome_no = 0.0
        if self.said:
            outcome_yes = self.said["yes"]
            outcome_no = self.said["no"]
        return False, {"yes": outcome_yes, "no": outcome_no}


def test_what_a_method_leaves_open_is_unknown():
    hooks = Made()
    one = risk(direct={"Near": "near"}, observed=["Human"], hooks=hooks)
    assert step(one, near="no").high == pytest.approx(0.2)
    assert one.facts().unknown_inputs == ("Human",)
    hooks.said = {"yes": 0.0, "no": 1.0}
    assert step(one, near="no").high == pytest.approx(0.05)
    assert one.facts().valid
    hooks.said = {"yes": 0.25, "no": 0.75}
    assert step(one, near="no").low == pytest.approx(step(one, near="no").high)
    hooks.node_Human = lambda: None
    assert step(one, near="no").high == pytest.approx(0.2)
    hooks.node_Human = lambda: (False, {"yes": math.nan, "no": 1.0})
    assert step(one, near="no").high == pytest.approx(0.2)
    assert not one.facts().valid


def test_a_method_counts_before_what_is_accepted():
    bins = {"Human": {"input": "human", "missing": "prior", **AS_TEXT}}
    hooks = Made()
    one = risk(direct={"Near": "near"}, bins=bins, hooks=hooks)
    assert step(one, near="no").high == pytest.approx(0.08)
    hooks.said = {"yes": 1.0, "no": 0.0}
    assert step(one, near="no").high == pytest.approx(0.2)
    assert (one.facts().accepted, one.facts().valid) == ((), True)
    hooks.said = {"yes": "?", "no": 0.0}
    assert step(one, near="no").high == pytest.approx(0.2)  # nobody accepted a method that fails
    assert one.facts().accepted == ()


def told(one):
    (row,) = one.why().values()
    return row.sentence


def test_a_threshold_says_what_it_lacks():
    one = risk()
    bounds = "Risk=High 0.05 .. 0.9, limit 0.3"
    step(one)
    assert told(one) == f"Low <- near: no value ({bounds}); human: no value ({bounds})"
    step(one, near="yes", human="yes")
    assert told(one) == "Low: Risk=High 0.9 for 0.0 s, limit 0.3"
    step(one, near="yes")
    assert told(one) == "Low: Risk=High 0.4 for 0.0 s, limit 0.3"  # at least
    step(one, near="no")
    assert told(one) == ""
    one = risk(threshold(at_most=0.3, hold_s=1.0))
    step(one, near="no", human="no")
    assert told(one) == "Low: good for 0.0 s of 1 s"
