"""State machines in the plain form of the oracle, as engines and as monitors."""

from __future__ import annotations

from functools import cache

import yaml
from eddi_runtime import InputSpec
from eddi_runtime.expressions import truth
from eddi_runtime.state_machine import (
    Action,
    Evidence,
    State,
    StateMachine,
    StateMachineMonitor,
    Transition,
    Trigger,
)

from tests.data_files import data_file

SECOND = 10**9
LETTERS = "FUT"
VALUES = {"F": False, "U": "no truth value", "T": True}


@cache
def oracle(name):
    return yaml.load(data_file(f"state_machines/{name}.yml").read_text(), yaml.CSafeLoader)


@cache
def models():
    return {model["name"]: model for model in oracle("models")["models"]}


def machine(model, config=None, **more):
    """Return what a compiled monitor declares."""
    config, made = config or {}, StateMachine()
    names = [state["name"] for state in model["states"]]
    flags, fails = model.get("triggers", {}), [s["name"] for s in model["states"] if s.get("fail")]
    rows = sorted(model["transitions"], key=lambda r: (r.get("priority", 0), r["to"] not in fails))
    texts = sorted({text for row in rows for text in row["triggers"]})
    raised = [text for text in texts if flags.get(text, {}).get("raised")]
    actions, states = [], []
    for state in model["states"]:
        numbers = {}
        for moment in ("entry", "exit"):
            given = state.get(moment, ())
            numbers[moment] = tuple(range(len(actions), len(actions) + len(given)))
            for one in given:
                raises = texts.index(one["text"]) if one["text"] in raised else -1
                target = one["text"].partition("=")[0] if "=" in one["text"] else ""
                row = (one["kind"], one["text"], target or one.get("source", ""))
                made_of = "".join(letter if letter.isalnum() else "_" for letter in one["text"])
                method = f"action_{made_of}" if one["kind"] == "function" else ""
                actions.append(Action(*row, one.get("level", 0), raises, method))
        is_initial, fail = bool(state.get("initial")), bool(state.get("fail"))
        states.append(State(state["name"], is_initial, fail, **numbers))
    inputs = inputs_of(model)
    triggers = []
    for text in texts:
        one = {key: bool(value) for key, value in flags.get(text, {}).items()}
        one = {key: one[key] for key in ("momentary", "raised", "persistent") if key in one}
        needs = () if one.get("raised") else tuple(inputs.index(k) for k in leaves(model, text))
        one["messages"] = one.get("momentary", False)
        triggers.append(Trigger(text, needs, **one, absent=text in config.get("absent", ())))
    transitions = []
    for row in rows:
        after = round(row["after"] * SECOND) if "after" in row else None
        ends = names.index(row["from"]), names.index(row["to"])
        numbers = tuple(texts.index(text) for text in row["triggers"])
        transitions.append(Transition(row.get("name", ""), *ends, numbers, after))
    evidence = []
    for claim in config.get("evidence", ()):
        inside = claim.get("in") or [name for name in names if name not in claim["not_in"]]
        hold = round(claim.get("hold", 0) * SECOND)
        evidence.append(Evidence(claim["id"], tuple(map(names.index, inside)), hold))
    gap = config.get("max_gap", max(1.0, 2.5 * config.get("period", 1.0)))
    made.states, made.actions, made.triggers = tuple(states), tuple(actions), tuple(triggers)
    made.transitions, made.evidence = tuple(transitions), tuple(evidence)
    made.start, made.max_gap = config.get("start", "initial"), round(gap * SECOND)
    return made


def leaves(model, text):
    """Return the basic events of a cause, else the text itself."""
    _, inputs = model.get("causes", {}).get(text, (None, None))
    return [text] if inputs is None else [leaf for one in inputs for leaf in leaves(model, one)]


def inputs_of(model):
    flags = model.get("triggers", {})
    texts = {text for row in model["transitions"] for text in row["triggers"]}
    own = sorted(text for text in texts if not flags.get(text, {}).get("raised"))
    return list(dict.fromkeys(leaf for text in own for leaf in leaves(model, text)))


def value(model, held, text):
    """Return the value of a cause or an input."""
    if text not in model.get("causes", {}):
        return held.get(text, 1)
    gate, inputs = model["causes"][text]
    values = sorted((value(model, held, one) for one in inputs), reverse=True)
    return values[{"OR": 1, "AND": len(values)}.get(gate, gate) - 1]


def monitor(model, config=None, actions=None, max_age=None):
    """Return a monitor with a boolean input for each text, observed state and the reset.

    That is an order, unless `level_reset` of the configuration makes it one of the others.
    """
    made, ids = machine(model, config), inputs_of(model)
    rows = model.get("triggers", {}).items()
    momentary = {text for text, flags in rows if flags.get("momentary")}
    level_reset = (config or {}).get("level_reset", False)
    momentary |= set() if level_reset else {"reset"}
    names = [state.id for state in made.states]
    every = [*ids, *(f"observed {name}" for name in names), "reset"]
    first = len(ids)

    class Monitor(StateMachineMonitor):
        model_id, digest = model["name"], ""
        inputs = tuple(
            InputSpec(
                one,
                one,
                requires=(one,),
                max_age="none" if one in momentary else max_age,
                every_message=one in momentary,
            )
            for one in every
        )
        types = tuple("" if one in momentary else "bool" for one in every)
        limits = (None,) * len(every)
        states, actions, triggers = made.states, made.actions, made.triggers
        transitions, evidence = made.transitions, made.evidence
        start, max_gap = made.start, made.max_gap
        observe = tuple((k, Trigger(name, (first + k,))) for k, name in enumerate(names))
        reset_by = Trigger("reset", (len(every) - 1,), messages=not level_reset)

        def step(self, source, t):
            self.raw = self.read(source)
            if t == self.last:
                return self.outputs
            self.last = t
            held = dict(zip(every, map(truth, self.raw)))
            read = [one.text for one in self.triggers if not (one.raised or one.messages)]
            rest = [held[one] for one in every[first:] if one not in momentary]
            self.outputs = (*(value(model, held, text) for text in read), *rest)
            return self.outputs

    return Monitor(actions)


def result(output, t):
    """Return an output as the oracle writes it."""
    rows = [(f"{one.moment} {one.state}: {one.kind} {one.text}", one) for one in output.raised]
    return {
        "possible": [*output.possible],
        "state": output.state or None,
        "failed": LETTERS[output.failed],
        "since": round(t - output.since_seconds, 9),
        "raised": [text for text, one in rows if one.certain],
        "maybe": sorted(text for text, one in rows if not one.certain),
        "evidence": dict(output.evidence),
        "reason": [*output.reasons],
    }
