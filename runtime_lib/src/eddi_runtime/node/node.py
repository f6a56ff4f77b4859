"""The node of one monitor on any transport: evaluate, publish, report, one step per period.

An adapter in ``eddi_runtime.transports`` adds how its transport subscribes, publishes and tells
the time, and how a process on it starts and ends.
"""

from __future__ import annotations

import time
import traceback
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable, ClassVar, List, Optional, Sequence

from ..inputs import EDDIInputBase
from ..monitor import ModelError, Monitor, Steps, __version__
from ..plain_values import one_line
from ..why import TRUE, why_tree
from .health import Diagnostics, Health, Told, first_reasons
from .report import GraphFact, Report
from .start import LOG, STARTUP_GRACE_S, Ending, Schedule, Settings, StartError, Waker
from .topics import (
    Converter,
    Input,
    MessageError,
    Output,
    Publications,
    Publish,
    Receipt,
    Receipts,
    Silence,
    check_outputs,
    each,
    why_topic,
)

if TYPE_CHECKING:  # travels where a monitor is one of a fleet
    from ..peers import Fleet


__all__ = ["Node"]


Options = Optional[Settings]
NewInput = Callable[[], EDDIInputBase]
NewMonitor = Callable[[], Steps]
Statuses = Callable[[List[Report]], None]
"""Publishes reports."""
REFUSALS = (StartError, ModelError, MessageError)
"""Why a node must not start."""
_NOTHING = object()
"""An input of which nothing is known: every evidence is UNKNOWN."""


class Node:
    """Base class of the nodes of a transport; the generated class sets the names in capitals."""

    NAME: ClassVar[str] = "eddi_monitor"  # of the node
    FREQUENCY: ClassVar[float] = 10.0  # steps per second; the parameter ``frequency`` wins
    # ``rate``, or ``on_change``: a message starts a step at once, and the node still steps at the
    # frequency, because otherwise nothing would ever become stale
    MODE: ClassVar[str] = "rate"
    # seconds in which an input may wait for its first message; ``startup_grace`` wins
    STARTUP_GRACE: ClassVar[float] = STARTUP_GRACE_S
    INPUTS: ClassVar[Sequence[Input]] = ()  # what to subscribe to
    OUTPUTS: ClassVar[Sequence[Output]] = ()  # what to publish
    MESSAGES: ClassVar[Any] = None  # module with the message classes that outputs are built from
    FLEET: ClassVar[Fleet | None] = None  # the robots among which this one is

    def __init__(
        self, monitor: Steps, eddi_input: EDDIInputBase, converter: Converter, options: Options
    ) -> None:
        if not hasattr(eddi_input, "begin_step"):  # one of the D7.2 tools
            raise StartError("EDDIInput.py is not the generated one: run `eddi-scaffold adopt`")
        core: Any = monitor
        self._core: Monitor[Any] = getattr(core, "monitor", core)
        self._core.deferred = True
        self.monitor = monitor
        self.eddi_input = eddi_input
        self.simulator_values: dict[str, Any] = {}  # the latest messages, at the present step
        self.options = options or Settings(self.FREQUENCY, startup_grace=self.STARTUP_GRACE)
        self.ending = Ending()
        self._simulated: int | None = None
        self._wake_teller: Callable[[], None] = lambda: None  # where nobody reports
        self._report_due = False
        self._told: object = None  # verdicts and first reasons that were published last
        self._publish_why: list[Publish] = []
        self._converter = converter
        self._publications: Publications | None = None
        self._sources = [*self.INPUTS]
        fleet, self._peers = self.FLEET, None
        self._tell: Publish = lambda _: None  # where a robot is alone
        if fleet is not None:
            self._peers = fleet.joined(self.options.robot, self._core.model_id, self._core.digest)
            self._sources.append(fleet.words())
        # by the id under which `processing` gets it: where monitors that it reads tell why
        reading = {name for spec in self._core.inputs for name, _ in spec.claims}
        why_class = converter.class_of("Why")
        self._why_inputs = {
            f"{source.id}/why": Input(
                why_topic(source.topic), source.topic, why_class, wakes=False
            )
            for source in self._sources
            if source.id in reading and why_class is not None
        }
        on_change, grace = self.MODE == "on_change", self.options.startup_grace
        self._silence = Silence(self._sources, grace)
        self._waker = Waker()
        self._schedule = Schedule(1.0 / self.options.frequency, on_change)
        heard = [*self._sources, *self._why_inputs.values()]
        self._receipts = Receipts(heard, self._waker.wake if on_change else lambda: None)
        self._health = Health(self._core, self.eddi_input, self._schedule.period, grace)

    # What a person adds, in the region ``RosNode.members``.

    def started(self) -> None:
        """Run once, before the first step."""

    def stepped(self, result: Any) -> None:
        """Run after each step, with what the monitor returned."""

    def _call(self, about: str, own: Callable[[], object]) -> None:
        """Call a person's method beside the monitor: what it raises is logged, and no more."""
        try:
            own()
            self._health.log_error(about, "")
        except Exception as caught:  # noqa: BLE001 - hand-written code may raise anything
            if not self.ending.begun:
                self._health.log_error(about, one_line(caught), traceback.format_exc())

    # What a transport adds.

    def simulated_ns(self) -> int | None:
        """Return the time of a simulation, ``None`` where there is none."""
        return None

    advertise: Callable[[Output], Publish]  # returns what sends to a topic
    # has every message of a topic stored in ``self._receipts``, with its age
    subscribe: Callable[[Input], None]

    def check_serialises(self, message: object) -> None:
        """Raise what sending would raise once somebody listens; for messages made by hand."""

    def graph(self) -> GraphFact:
        """Return what is known of the graph around the node; called for each report."""
        return GraphFact()

    def resolved(self, topic: str) -> str:
        """Return the full name of a topic; namespaces and remapping apply."""
        return topic

    # What all have.

    def now_ns(self) -> int:
        """Return the time of a step: simulated if there is such a time; warn if it jumps back."""
        now = self.simulated_ns()
        if now is None:
            return time.monotonic_ns()
        if self._simulated is not None and now < self._simulated:
            LOG.warn("/clock jumped back by %.3f s", (self._simulated - now) / 1e9)
        self._simulated = now
        return now

    def create_ros_msg(self, eddi_output: object) -> object:
        """Return the message of an output of ``execute_step``; a list, None for none."""
        return self._converter.messages(self._core.message(eddi_output))

    def init_publisher(self) -> None:
        """Advertise every output topic, and why the claims on it are as they are."""
        topics = {source.id: self.resolved(source.topic) for source in self._sources}
        self._publications = Publications(self.OUTPUTS, self.advertise)
        if self.FLEET is not None:
            fleet = self.FLEET
            self._tell = self.advertise(Output("", fleet.topic, fleet.type))
            topics.update((source.id, self.resolved(fleet.topic)) for source in fleet.sources)
        self._core.topics = topics
        why_class = self._converter.class_of("Why")
        results = [row for row in self.OUTPUTS if not (row.field or row.of)] or self.OUTPUTS[:1]
        if why_class is not None:
            names = dict.fromkeys(why_topic(self.resolved(output.topic)) for output in results)
            self._publish_why = [self.advertise(Output("", name, why_class)) for name in names]

    def init_subscriber(self) -> None:
        """Subscribe to every input topic, and to the reasons of the monitors among them."""
        for source in self._sources:
            self.subscribe(source)
        for source in {source.id: source for source in self._why_inputs.values()}.values():
            self.subscribe(source._replace(topic=why_topic(self.resolved(source.topic))))

    def begin(self, name: str, diagnostics: Diagnostics) -> None:
        """Advertise, publish once and subscribe; ``name`` is that in the diagnostics."""
        self.ending.on_end(self._waker.wake)
        self.log_start()
        self.init_publisher()
        self._call("started", self.started)
        self.step()  # before any message can arrive: nothing is known, nothing is active
        self.init_subscriber()
        title = f"{name.lstrip('/')}: {self._core.model_id}"
        self._wake_teller = diagnostics.add(
            lambda periodic: self.tell(periodic, title, name), name
        )

    def run_on(
        self, name: str, publisher: Callable[[], Statuses], begun: Callable[[], None]
    ) -> None:
        """Be the one monitor of a process, until that ends."""
        diagnostics = Diagnostics(publisher() if self.options.diagnostics else lambda _: None)
        self.begin(name, diagnostics)
        begun()
        self.ending.on_end(diagnostics.stop)
        diagnostics.start()
        self.ros_main()

    def report_now(self) -> None:
        """Publish the diagnostics at once, where they are."""
        self._report_due = self.options.diagnostics
        self._wake_teller()

    def ros_main(self) -> None:
        """Run steps until the node ends."""
        self._schedule.start(time.monotonic())
        while not self.ending.begun:
            self._waker.wait(self._schedule.wait_s(time.monotonic()))
            if self.ending.begun:
                return
            started = time.monotonic()
            self.step()
            self._schedule.stepped(started, time.monotonic())

    def step(self) -> None:
        """Evaluate the latest messages and publish the result; never raises.

        Whatever goes wrong, the result of knowing nothing is published: no old guarantee stays
        active.
        """
        started = time.monotonic()
        receipts, new = self._receipts.taken()
        try:
            output = self._evaluate(receipts, new, started)
            if self.ending.begun:  # meanwhile: another may have said its last word already
                return
            error = self._publish(output)
            self._core.published(lambda text: LOG.warn("%s", text), self._health.log_error)
            self._health.log_error("step", error)
            self._call("stepped", lambda: self.stepped(output))
        except Exception as caught:  # noqa: BLE001 - hand-written code may raise anything
            if self.ending.begun:
                return
            error = one_line(caught)
            self._health.log_error("step", error, traceback.format_exc())
            output = self.withdraw()
        try:
            duration = time.monotonic() - started
            level_changed, claim_changed = self._health.after_step(
                output, receipts, error, duration
            )
            if level_changed:
                self.report_now()
            elif claim_changed:
                self._wake_teller()
        except Exception as caught:  # noqa: BLE001 - a report must never end the monitor
            self._health.log_error("report", one_line(caught), traceback.format_exc())

    def _evaluate(
        self, receipts: dict[str, Receipt], new: dict[str, list[object]], now: float
    ) -> Any:
        words = {} if self._peers is None else self._peers.take(receipts, new, now)
        for name, source in self._why_inputs.items():
            if source.id in receipts:
                receipts[name] = receipts[source.id]
        unfit = {name for name, word in words.items() if word.unfit}
        latest = {name: receipt.message for name, receipt in receipts.items() if name not in unfit}
        self.simulator_values = latest
        ages = {name: receipt.age_at(now) for name, receipt in receipts.items()}
        t_ns = self.now_ns()
        timeless = "use_sim_time is set, and nothing has come on /clock: time stands still"
        self._health.log_error("time", "" if t_ns else timeless)
        self.eddi_input.begin_step(ages, new or None, t_ns, words or None)
        if new:
            self._health.log_error("queue", self._receipts.dropped())
        self.eddi_input.processing(self.simulator_values)
        self.eddi_input.end_step()
        return self.monitor.execute_step(self.eddi_input, t_ns)

    def _publish(self, output: Any) -> str:
        """Publish an output; return what was wrong with it although it could be published."""
        if self._publications is None:
            return ""
        message = self.create_ros_msg(output)
        if type(self).create_ros_msg is not Node.create_ros_msg:  # made by hand
            for part in each(message):
                self.check_serialises(part)
        self._publish_all(self._publications, message)
        return "; ".join(self._core.output_faults())

    def _publish_all(self, publications: Publications, message: object) -> None:
        publications.publish(message)
        if self._peers is not None:
            word = self._peers.told(message, self._core, time.monotonic())
            self._tell(self._converter.message(word))
        for name in publications.beside:
            publications.publish(self._converter.beside(self._core, name), name)

    def withdraw(self) -> Any:
        """Publish what holds when nothing is known, by our own code only, and return it."""
        output = None
        try:
            output = self._core.execute_step(_NOTHING, self.now_ns())
            if self._publications is not None:
                self._publish_all(self._publications, Node.create_ros_msg(self, output))
            self._health.log_error("output", "")
        except Exception as caught:  # noqa: BLE001 - the loop must go on
            self._health.log_error("output", one_line(caught), traceback.format_exc())
        return output

    def tell(self, periodic: bool, title: str = "", name: str = "") -> Told:
        """Publish and log why claims are as they are, and report; called by a thread for that."""
        if self.ending.begun:  # the last word is said, or is just being said
            return Told()
        self._silence.suspected = self._health.suspected
        graph = self.graph()
        self._call("why", lambda: self._tell_why(graph, periodic))
        report = None
        if self._report_due or (periodic and self.options.diagnostics):
            self._report_due = False
            report = self.status(graph, periodic=periodic)._replace(name=title, node=name)
        return Told(report, self._health.waits)

    def _tell_why(self, graph: GraphFact, periodic: bool) -> None:
        why = self._health.told(graph)
        reasons, lacks = first_reasons(why), any(row.verdict != TRUE for row in why.values())
        if self._publish_why and (reasons != self._told or (periodic and lacks)):
            self._told = reasons
            message = self._converter.message(why_tree(self._core.model_id, why))
            for publish in self._publish_why:
                publish(message)

    def status(self, graph: GraphFact, *, periodic: bool) -> Report:
        """Return the present report; called by the same thread."""
        facts = self._receipts.latest(), self._schedule.overruns, graph
        return self._health.collect(*facts, periodic=periodic)

    def log_start(self) -> None:
        core, folder = self._core, Path(__file__).resolve().parents[1]
        unlimited = [spec.id for spec in core.inputs if spec.max_age is None]
        text = "monitor of %s (%s), model digest %s, eddi_runtime %s from %s,"
        values = (core.model_id, core.kind, core.digest, __version__, folder)
        without = ", ".join(unlimited) or "none"
        LOG.info(f"{text} inputs without max_age: %s", *values, without)

    def prepare(self) -> None:
        """Do what can fail before anything is registered (MessageError)."""
        self.eddi_input.bind(self._core.inputs)
        result = self._core.message(self._core.execute_step(_NOTHING))
        try:
            check_outputs(self._converter, result, self._core, self.OUTPUTS)
            if self._peers is not None:
                made = self._converter.messages(result)
                self._converter.message(self._peers.told(made, self._core, time.monotonic()))
        except MessageError as error:
            raise MessageError(f"the messages do not fit the model: {error}") from error
        self._core.reset()
