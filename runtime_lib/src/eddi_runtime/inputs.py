"""Inputs of a monitor: the description of each and the base class of ``EDDIInput``."""

from __future__ import annotations

import math
import time
from contextlib import suppress
from typing import Any, Callable, Mapping, NamedTuple, Sequence

from .plain_values import (
    UNTOLD,
    Absent,
    NotGivenError,
    as_message,
    one_line,
    plain,
    read,
    type_name,
)
from .why import FALSE, NAN, TEXTS, Cause, holds, named, told

NO_TIME = "the time of the step is no whole number of nanoseconds"
_LARGEST = 2**63


def step_time(given: object) -> int | None:
    """Return the time of a step in nanoseconds, None for what is none; never raises."""
    if given is None:
        return time.monotonic_ns()
    given = given if type(given) is int else plain(given)
    if type(given) is not int:
        return None
    return given if -_LARGEST <= given < _LARGEST else None


UNKNOWN_AGE = float("inf")
"""Age of a message that was latched on subscription: above all limits until the next one comes."""
UNDECIDED = "not known yet"  # of an expression, whose windows fill
TWO_CLOCKS = "two clocks"
"""Why an age is not known: it began by another clock than that of now, or one that went back."""


Method = Callable[..., object]
"""Takes messages and sets an attribute; a person writes what is in it."""
Latest = Mapping[str, object]
"""SimulatorOutput id -> its latest message."""


class InputSpec(NamedTuple):
    """One input of a model."""

    id: str  # as in the model
    attribute: str  # name of the attribute of ``EDDIInput`` that holds the value
    requires: tuple[str, ...] = ()  # ids of the SimulatorOutputs that the value is made of
    # seconds from receipt until a message is stale; never: ``"none"`` on purpose, else ``None``
    max_age: float | str | None = None
    # numerator and denominator: a given number times this is in the model's unit
    factor: tuple[int, int] | None = None
    default: object = None  # value before the first message
    every_message: bool = False  # the attribute holds the list of all values since the last step
    # class of ``compiled.py`` that computes what ``expression`` gives
    expression: Callable[[], Any] | None = None
    # keys but ``max_age: none`` by which a value of it is accepted that is not confirmed
    accepts: tuple[str, ...] = ()
    # claims of other monitors that it reads: a SimulatorOutput id, and the id of the claim, empty
    # for that which the message names
    claims: tuple[tuple[str, str], ...] = ()


UNSAFE_DEFAULT = "allow_unsafe_default: true"
"""The one key of ``accepts`` that counts before the first message, and only then."""


class InputState(NamedTuple):
    """How the last ``processing`` went for one input."""

    # ``ok``, ``missing`` (no message yet), ``stale`` (older than ``max_age``), ``untold`` (another
    # monitor does not know it) or ``invalid`` (the method raised or left the value at None)
    state: str
    reason: str = ""  # one line for people, empty when ok
    # seconds since the oldest required message, ``None`` when one is missing
    age: float | None = None
    detail: str = ""  # traceback of the present reason, empty when there is none
    # whose words the value is made of, where it is made of those of other robots
    robots: tuple[str, ...] = ()
    sources: tuple[str, ...] = ()  # SimulatorOutput ids of messages that are missing or too old
    text: str = ""  # of a cause, where it says more than the reason


_NEW = InputState("missing", "no message yet")


class Word(NamedTuple):
    """Whose word a message is, among robots."""

    robot: str  # its name, empty where none of several was heard
    unfit: str = ""  # why it does not count, empty when it does
    age: float = NAN  # seconds since it was told
    lease: float = NAN  # seconds for which it counts


def accepted(specs: Sequence[InputSpec], eddi_input: object) -> tuple[str, ...]:
    """Return ``input: key`` for each key of the inputs in use in this step; never raises.

    Where the messages are not watched (``states``), no input is known to rest on such a key.
    """
    words: list[str] = []
    states = states_of(eddi_input)
    for spec in specs:
        limitless = spec.max_age == "none"
        if (limitless or spec.accepts) and spec.id in states:
            value = read(eddi_input, spec.attribute, spec.id)
            if value is not None and type(value) is not Absent:
                default = states[spec.id].state == "missing"  # is what it holds
                keys = [key for key in spec.accepts if (key == UNSAFE_DEFAULT) == default]
                keys = ["max_age: none", *keys] if limitless and not default else keys
                words += [f"{spec.id}: {key}" for key in keys]
    return tuple(words)


def states_of(eddi_input: object) -> Mapping[str, InputState]:
    """Return the ``states`` of an ``EDDIInput``, none of any other object; never raises."""
    states = read(eddi_input, "states", "states")
    if type(states) is dict and all(type(state) is InputState for state in states.values()):
        return states
    return {}


def look_again(eddi_input: object, t_ns: int | None) -> float:
    """Make unknown what is too old at a step; return the seconds since ``processing``."""
    given: Any = eddi_input
    return given.look_again(t_ns) if issubclass(type(given), EDDIInputBase) else 0.0


class EDDIInputBase:
    """Base of the generated ``EDDIInput``: an input that cannot be trusted becomes None.

    A message that is handed in as another object than before is new; the same object ages.
    """

    # generated: takes the latest messages by SimulatorOutput id, and the time in nanoseconds
    processing: Callable[..., object]
    # how the last ``processing`` went for each input, for reports only: monitors decide by values
    states: dict[str, InputState]

    # Two underscores: an input may be called anything else, `_ages` as well.

    def __init__(self, specs: Sequence[InputSpec] = ()) -> None:
        self.states = {}
        # as told for this step
        self.__ages: Mapping[str, float] | None = None
        self.__new: Mapping[str, Sequence[object]] | None = None
        self.__words: Mapping[str, Word] = {}
        self.__begun = False  # a step for which ``processing`` has not been called
        self.__own = True  # is the clock the machine's own
        self.__now: int | None = None  # time of the step by it, None before and where it is none
        # by SimulatorOutput id: the latest message, and when it came, None where that is not known
        self.__arrivals: dict[str, tuple[object, int | None]] = {}
        self.__arrived: set[str] = set()  # of these in this step
        # input id -> until when its value counts, and its limit in seconds
        self.__due: dict[str, tuple[int, float]] = {}
        self.__unknown: dict[str, object] = {}
        # for people: when all began, when the state of an input did, and the last look
        self.__start: int | None = None
        self.__began: dict[str, int | None] = {}
        self.__looked: int | None = None
        self.__latest: Latest = {}  # of inputs that read claims
        self.bind(specs)

    def setup(self) -> None:
        """Run a person's lines once, when all inputs have their defaults."""

    def processed(self, simulator_outputs: Mapping[str, object]) -> None:
        """Run a person's lines in each step; the node withdraws its result when this raises."""

    def bind(self, specs: Sequence[InputSpec]) -> None:
        """Take over attribute names, age limits and expressions, where ``EDDIInput`` has none."""
        self.__specs = {spec.id: spec for spec in specs}
        self.__reading = {
            spec.id: [f"{name}/why" for name, _ in spec.claims] for spec in specs if spec.claims
        }
        self.__defaults = {
            spec.attribute: getattr(self, spec.attribute, spec.default) for spec in specs
        }

    def begin_step(
        self,
        ages: Mapping[str, float] | None = None,
        new: Mapping[str, Sequence[object]] | None = None,
        t_ns: int | None = None,
        words: Mapping[str, Word] | None = None,
    ) -> None:
        """Begin a step: what is told here holds for the next ``processing``.

        Args:
            ages: SimulatorOutput id -> age of its latest message in seconds; absent means fresh.
                None: as the objects tell that are handed in.
            new: SimulatorOutput id -> the messages since the last step, oldest first, for inputs
                that take every message; None: the latest, where it is another object than before.
            t_ns: time of the step in nanoseconds; None: the monotonic clock.
            words: SimulatorOutput id -> whose word it is, for those of other robots.
        """
        self.__ages, self.__new, self.__words = ages, new, words or {}
        self.__begun = True
        self.__keep_time(t_ns)

    def begin_processing(self, t_ns: int | None = None) -> None:
        """Begin a step unless that has been done; the first line of ``processing``."""
        if not self.__begun:
            self.begin_step(t_ns=t_ns)
        elif t_ns is not None:
            self.__keep_time(t_ns)
        self.__begun = False

    def __keep_time(self, t_ns: int | None) -> None:
        now = step_time(t_ns)
        if (t_ns is None) is not self.__own:
            self.__arrivals = {name: (row[0], None) for name, row in self.__arrivals.items()}
            self.__doubt_time()
            self.__start = None
        self.__own, self.__now, self.__arrived = t_ns is None, now, set()
        self.__looked = now
        if self.__start is None or (now is not None and now < self.__start):
            self.__start, self.__began = now, {}

    def __doubt_time(self) -> None:
        for name in [*self.__due]:
            self.__leave(name, InputState("stale", TWO_CLOCKS), None)

    def received(self, source: str) -> None:
        """Have the same object count as a new message in the next ``processing``."""
        self.__arrivals.pop(source, None)

    def look_again(self, t_ns: int | None) -> float:
        """Make unknown what is too old at the time of a step; see the function of this name."""
        now, then = step_time(t_ns), self.__now
        if now is None or then is None or now < then or (t_ns is None) is not self.__own:
            self.__doubt_time()
            return 0.0
        self.__looked = now
        for name, (due, limit) in [*self.__due.items()]:
            if now > due:
                self.__leave(name, _late(limit + (now - due) / 1e9, limit), None)
        return (now - then) / 1e9

    def end_step(self) -> None:
        """Take back what methods of other inputs have set for those that are not known."""
        for attribute, value in self.__unknown.items():
            setattr(self, attribute, value)

    def update(
        self, input_id: str, process: Method, simulator_outputs: Latest, requires: Sequence[str]
    ) -> None:
        """Call ``process`` with the messages it requires; never raises.

        Without a message the default is kept if there never was a value, else it becomes None: a
        value whose source has gone is no evidence. So it does when a message is too old, or the
        call fails.
        """
        attribute, _ = self.__spec(input_id)
        before = self.states.get(input_id, _NEW)
        try:
            messages, _, after = self.__received(input_id, simulator_outputs, requires)
            if after.state == "ok":
                setattr(self, attribute, None)  # a value of an earlier message is no evidence
                process(*messages)
                if getattr(self, attribute, None) is None:
                    text = f"process_{attribute} assigned nothing"
                    after = InputState(
                        "invalid", "its method left it at None", after.age, text=text
                    )
        except Exception as problem:  # noqa: BLE001 - whatever a person's method raises
            after = invalid(problem, before)
        if after.state == before.state == "missing":  # from the start: the default is kept
            now = getattr(self, attribute, None)
            value = self.__unknown.get(attribute, self.__defaults.get(attribute, now))
        else:
            value = getattr(self, attribute, None) if after.state == "ok" else None
        self.__leave(input_id, after, value)

    def __leave(self, input_id: str, state: InputState, value: object) -> None:
        """Give an input its value of this step."""
        attribute, limit = self.__spec(input_id)
        setattr(self, attribute, value)
        before = self.states.get(input_id)
        self.states[input_id] = state
        if before is None or before.state != state.state:
            self.__began[input_id] = self.__looked
        if state.state != "ok":
            self.__unknown[attribute] = value
            self.__due.pop(input_id, None)
            return
        self.__unknown.pop(attribute, None)
        if isinstance(limit, (float, int)):
            left = limit - (state.age or 0.0)
            self.__due[input_id] = (self.__now or 0) + round(left * 1e9), limit

    def __spec(self, input_id: str) -> tuple[str, float | str | None]:
        """Return the attribute of an input and how old its messages may be."""
        spec = self.__specs.get(input_id)
        return (input_id, None) if spec is None else (spec.attribute, spec.max_age)

    def __received(
        self, input_id: str, simulator_outputs: Latest, requires: Sequence[str]
    ) -> tuple[list[object], list[float], InputState]:
        """Return the latest messages, their ages, and whether they are there and fresh."""
        if input_id in self.__reading:
            self.__latest = simulator_outputs
            for name in self.__reading[input_id]:
                if name in simulator_outputs:
                    self.__age(name, simulator_outputs[name])  # it is noted when it came
        messages = [simulator_outputs.get(name) for name in requires]
        ages = [self.__age(name, message) for name, message in zip(requires, messages)]
        messages = [as_message(message) for message in messages]
        absent = [name for name, message in zip(requires, messages) if message is None]
        unfit = [self.__words[name].unfit for name in absent if name in self.__words]
        if unfit:
            heard = all(name in self.__words and name in (self.__ages or ()) for name in absent)
            kind, reason = "stale" if heard else "missing", "; ".join(unfit)
            return messages, ages, InputState(kind, reason, sources=tuple(absent))
        if absent:
            reason = f"no message of {', '.join(absent)}"
            return messages, ages, InputState("missing", reason, sources=tuple(absent))
        state = aged(ages, self.__spec(input_id)[1])
        if state.age == UNKNOWN_AGE and self.__ages is None and state.state != "ok":
            state = state._replace(reason=TWO_CLOCKS)
        return messages, ages, state._replace(robots=self.__robots(requires))

    def __age(self, name: str, message: object) -> float:
        """Return the age of a message in seconds: as told, else since another one was there."""
        if self.__ages is not None:
            return self.__ages.get(name, 0.0)
        now, known = self.__now, self.__arrivals.get(name)
        if message is not None and (known is None or known[0] is not message):
            self.__arrivals[name] = message, now
            self.__arrived.add(name)
            return UNKNOWN_AGE if now is None else 0.0
        then = None if known is None else known[1]
        if now is None or then is None or now < then:
            return UNKNOWN_AGE
        return (now - then) / 1e9

    def why(
        self, spec: InputSpec, verdict: int, since: float, topics: Mapping[str, str]
    ) -> list[Cause]:
        """Return why an input is not good, as its messages tell it; none where its value does.

        Args:
            spec: of the input.
            verdict: what it counts for, FALSE or UNKNOWN.
            since: seconds for which it has been that.
            topics: SimulatorOutput id -> full name of its topic.
        """
        state = self.states.get(spec.id, _NEW)
        if state.state in {"missing", "stale"}:
            late = [name for name in spec.requires if not self.__age_now(name) <= _limit(spec)]
            names = state.sources or late or spec.requires
            return [self.__of_message(spec, state, name, topics.get(name, "")) for name in names]
        if state.state == "invalid":
            text = state.text or state.reason
            if state.reason == UNDECIDED:
                since = self.known_for((spec,))
                return [Cause((), "window", TEXTS["window"], since=since)]
            return [of_topic(spec, topics, Cause((), "invalid", text, since=since))]
        causes = self.__of_claims(spec, verdict, since)
        if state.state == "untold" and not causes:
            causes = [of_topic(spec, topics, Cause((), "untold", TEXTS["untold"], since=since))]
        return causes

    def __of_message(self, spec: InputSpec, state: InputState, name: str, topic: str) -> Cause:
        age, limit, word = self.__age_now(name), _limit(spec), self.__words.get(name)
        path = (topic,) if topic else ()
        if word is not None:
            claims = [self.__link(name, claim) for source, claim in spec.claims if source == name]
            text = f"robot {word.robot} silent {{age}}, lease {{limit}}"
            text = text if word.lease < word.age < math.inf else word.unfit
            return Cause(tuple(claims), "robot", text, topic, (), word.age, word.age, word.lease)
        if state.state == "missing":
            return Cause(path, "never", TEXTS["never"], topic, since=self.__lasting(self.__start))
        if state.reason == TWO_CLOCKS or age == UNKNOWN_AGE:
            text = TWO_CLOCKS if state.reason == TWO_CLOCKS else TEXTS["latched"]
            since = self.known_for((spec,))
            return Cause(path, "latched", text, topic, (), since, limit=limit)
        return Cause(path, "silent", TEXTS["silent"], topic, (), age, age, limit)

    def __of_claims(self, spec: InputSpec, verdict: int, since: float) -> list[Cause]:
        """Return why claims that an input reads are as they are, as their monitors tell it."""
        causes: list[Cause] = []
        # links to claims that hold, and to those of which nothing is told
        held: list[tuple[str, ...]] = []
        silent: list[tuple[str, ...]] = []
        for source, id_ in spec.claims:
            message, key = as_message(self.__latest.get(source)), f"{source}/why"
            claim = id_ or named(message)
            link = self.__link(source, claim)
            path = () if link == spec.id else (link,)
            told_causes = told(self.__latest.get(key), claim, self.__age_now(key), verdict)
            causes += [cause.under(link) if path else cause for cause in told_causes]
            if not told_causes:
                (held if holds(message, claim) else silent).append(path)
        others = set(spec.requires).difference([source for source, _ in spec.claims])
        if causes or (verdict == FALSE and others):  # where none is told, it is not these
            return causes
        if verdict == FALSE and held:  # it is read as NOT
            return [Cause(path, "false", "true for {since}", since=since) for path in held]
        return [Cause(path, "untold", TEXTS["untold"], since=since) for path in silent]

    def __link(self, source: str, claim: str) -> str:
        word = self.__words.get(source)
        return f"{word.robot}/{claim}" if word is not None and word.robot else claim

    def known_for(self, specs: Sequence[InputSpec]) -> float:
        """Return for how many seconds the states of inputs have been as they are."""
        began = [self.__began.get(spec.id) for spec in specs]
        return min([self.__lasting(time) for time in began], default=math.inf)

    def __lasting(self, began: int | None) -> float:
        now = self.__looked
        began = self.__start if began is None or now is None or now < began else began
        return 0.0 if now is None or began is None else max(now - began, 0) / 1e9

    def __age_now(self, name: str) -> float:
        """Return the age of the last message at the last look, in seconds."""
        then = self.__now
        if self.__ages is not None:
            return self.__ages.get(name, 0.0) + self.__lasting(then)
        _, came = self.__arrivals.get(name, (None, None))
        return UNKNOWN_AGE if came is None else self.__lasting(came)

    def __robots(self, requires: Sequence[str]) -> tuple[str, ...]:
        return tuple(self.__words[name].robot for name in requires if name in self.__words)


def aged(ages: Sequence[float], limit: float | str | None) -> InputState:
    """Return whether messages of these ages are fresh."""
    age = max(ages, default=0.0)
    # "<=" for each and not ">" for the oldest: an age of NaN is no proof of freshness.
    if limit is None or isinstance(limit, str) or all(each <= limit for each in ages):
        return InputState("ok", "", age)
    if age == UNKNOWN_AGE:
        return InputState("stale", "the last message was latched, its age is not known", age)
    return _late(age, limit)


def _limit(spec: InputSpec) -> float:
    """Return how old its messages may be in seconds."""
    limit = spec.max_age
    return math.inf if limit is None or isinstance(limit, str) else limit


def of_topic(spec: InputSpec, topics: Mapping[str, str], cause: Cause) -> Cause:
    """Return a cause with the topic of an input, if it has but one."""
    topic = topics.get(spec.requires[0], "") if len(spec.requires) == 1 else ""
    return cause._replace(path=(topic,), topic=topic) if topic else cause


def _late(age: float, limit: float) -> InputState:
    reason = f"the last message is {age:.3g} s old, the limit is {limit:g} s"
    return InputState("stale", reason, age)


def invalid(problem: Exception, before: InputState | None) -> InputState:
    """Return the state of an input whose method raised; its traceback is made once."""
    if isinstance(problem, NotGivenError):
        return InputState("untold", UNTOLD)
    reason, lines = one_line(problem), []
    if before is not None and before.state == "invalid" and before.reason == reason:
        return before._replace(age=None)
    import traceback  # noqa: PLC0415 - 3 ms of every start, for what rarely happens

    with suppress(Exception):  # an exception may fail to print itself
        lines = traceback.format_exception(type(problem), problem, problem.__traceback__)
    return InputState("invalid", reason, None, "".join(lines), text=_raised(problem))


def _raised(problem: Exception) -> str:
    """Return which method of a person raised something, and where; empty for code of ours."""
    within = problem.__traceback__ and problem.__traceback__.tb_next
    methods = ("process_", "action_")
    if within is None or not within.tb_frame.f_code.co_name.startswith(methods):
        return ""
    code, name = within.tb_frame.f_code, type_name(problem)
    file = code.co_filename.replace("\\", "/").rpartition("/")[2]
    return f"{code.co_name} raised {name} in {file} line {within.tb_lineno}"
