"""The demonstration of SESAME D7.2 Fig 46: publish evidence, see guarantees become active."""

import itertools

SYSTEM_A, SYSTEM_B = "/conserta/guarantees", "/consertb/guarantees"
GUARANTEES = {SYSTEM_A: ("System_A_G0", "System_A_G1"), SYSTEM_B: ("System_A_G0_c2",)}
EVIDENCE_A = "/rte/e0a"
EVIDENCE_B = {"/rte/e0b": "RtE_A_E0"}  # topic -> input
PATIENCE_S = 30.0


def all_of(topic, active):
    """Return the state in which every guarantee of a topic is active, or none."""
    return dict.fromkeys(GUARANTEES[topic], active)


def demonstrate(run, evidence_of_b=EVIDENCE_B, *, steady=True):
    """Publish the evidence step by step and check every published guarantee."""
    for topic in GUARANTEES:
        run.wait_for(topic, all_of(topic, active=False), PATIENCE_S)
    *parts, (last, _) = evidence_of_b.items()
    for topic, name in parts:
        run.publish(topic)
        run.wait_for_input("/consertb", name, PATIENCE_S)
    _never_active(run, SYSTEM_A)
    _never_active(run, SYSTEM_B)
    run.publish(last)
    run.wait_for(SYSTEM_B, all_of(SYSTEM_B, active=True), PATIENCE_S)
    _never_active(run, SYSTEM_A)
    evidence_of_a = run.publish(EVIDENCE_A)
    run.wait_for(SYSTEM_A, all_of(SYSTEM_A, active=True), PATIENCE_S)
    for topic in GUARANTEES:
        _check_history(topic, run.states(topic), steady=steady)
    return evidence_of_a


def _never_active(run, topic):
    early = [state for state in run.states(topic) if any(state.values())]
    assert not early, f"{topic} was active before its evidence: {early[0]}"


def _check_history(topic, states, *, steady):
    """Check everything that was published on a topic, from the start to the end."""
    assert {tuple(state) for state in states} == {GUARANTEES[topic]}, topic
    assert states[0] == all_of(topic, active=False), f"{topic} began with {states[0]}"
    lost = [
        (before, after)
        for before, after in itertools.pairwise(states)
        if any(before[name] and not after[name] for name in before)
    ]
    assert not (steady and lost), f"{topic} lost a guarantee: {lost[0]}"
