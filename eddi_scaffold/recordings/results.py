"""What is reported of monitors that a recording is played to."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from eddi_runtime.monitor import Value
from eddi_runtime.why import FALSE, TRUE, UNKNOWN, ClaimWhy, Why, clean

from eddi_scaffold.common.problems import EddiError, did_you_mean, problem
from eddi_scaffold.diagrams.plot import plot, tracks_of
from eddi_scaffold.recordings.playing import Playback

_ONLY_INPUTS = "unknown inputs"
"""The reason of a result that only lacks inputs: those of its claims are more precise."""
_SHOWN = 3  # chains at the end of a line
_HOLDS = {FALSE: False, UNKNOWN: None, TRUE: True}


def steps(play: Playback) -> Iterator[dict[str, Any]]:
    """Yield time in seconds, inputs and output as JSON for each step, and why each claim is so.

    A step without output has the reason. Lists are left out of the inputs. With several monitors,
    each entry has the name of its monitor.
    """
    for monitor, step in play:
        running = monitor.running
        row: dict[str, Any] = {"t": step.t}
        if monitor.name:
            row["monitor"] = monitor.name
        row["inputs"] = {name: _plain(value) for name, value in _single(step.inputs)}
        row["outputs"] = running.as_json(step.output)
        whys = {name: why.as_json() for name, why in running.why().items()}
        if whys:
            row["why"] = whys
        if row["outputs"] is None and hasattr(running, "status_name"):
            row["status"] = running.status_name()
        if hasattr(running, "beside_json"):
            row.update(running.beside_json())
        yield row


def changes(play: Playback) -> Iterator[str]:
    """Yield a line for the first step of each monitor, and for each with a new verdict or reason.

    A verdict is what the kind calls one, the reason why it is not to be relied on, or the first
    reason of a claim that does not hold; not each digit. A line has every value of the step, what
    else is wrong, and the chains of its claims.
    """
    last: dict[str, object] = {}
    for monitor, step in play:
        running, output, whys = monitor.running, step.output, monitor.running.why()
        reason, decided = str(getattr(output, "reason", "")), dict(running.decided(output))
        decided |= {name: None for name, why in whys.items() if why.verdict == UNKNOWN}
        state = decided, reason, [*map(_first, whys.values())]
        if last.get(monitor.name) == state:
            continue
        last[monitor.name] = state
        values = {**running.series(output), **decided}
        named = [(k, value) for k, value in values.items() if k not in running.unlogged]
        text = "  ".join(f"{name} {_shown(value)}" for name, value in named)
        if reason and not hasattr(running, "omission") and (reason != _ONLY_INPUTS or not whys):
            text += f"  {reason}" if getattr(output, "valid", False) else f"  not valid: {reason}"
        name = f"{monitor.name}: " if monitor.name else ""
        whys = {k: why for k, why in whys.items() if k not in running.unlogged}
        yield f"{step.t:10.3f}  {name}{text}{_chains(whys)}".rstrip()


def sentences(play: Playback, claim: str) -> Iterator[str]:
    """Yield a line when a claim, as ``ID`` or ``MONITOR.ID``, has a new value or first reason.

    Raises:
        EddiError: nothing played has such a claim (G008).
    """
    last: dict[str, object] = {}
    for monitor, t, why in told(play, claim):
        if last.get(monitor) != _first(why):
            last[monitor] = _first(why)
            yield f"{t:10.3f}  {f'{monitor}: ' if monitor else ''}{sentence(why)}"


def told(play: Playback, claim: str) -> Iterator[tuple[str, float, ClaimWhy]]:
    """Yield the monitor, the time, and why a claim is as it is, in each step that tells it.

    A hazard that is absent is told as ``NOT ID``.

    Raises:
        EddiError: as for ``sentences``.
    """
    names: dict[str, bool] = {}
    for monitor, step in play:
        for name, why in monitor.running.why().items():
            names[name] = is_meant = claim in (name, f"{monitor.name}.{name}")
            if is_meant:
                is_absent = why.verdict == TRUE and name in monitor.running.hazards
                yield monitor.name, step.t, why._replace(id=f"NOT {name}") if is_absent else why
    if not any(names.values()):
        raise no_claim(claim, names)


def no_claim(claim: str, names: Collection[str]) -> EddiError:
    """Return the error that no monitor tells of a claim; they tell of those of the names."""
    hint = did_you_mean(claim, names) or f"there are: {', '.join(names) or 'none'}"
    return EddiError(problem("G008.claim", hint=hint, claim=claim))


def sentence(why: ClaimWhy) -> str:
    """Return the sentence of a claim, also of one that holds."""
    return why.sentence or f"{why.id} holds"


def _first(why: ClaimWhy) -> object:
    """Return what is another when a claim has another value or first reason."""
    return why.verdict, *((one.path, one.state) for one in why.causes[:1])


def _chains(whys: Why) -> str:
    """Return the chains of all claims of a monitor, each once, as the end of a line."""
    causes = [(name, cause) for name, why in whys.items() for cause in why.causes]
    texts = [of.chain if of.path else f"{name}: {of.said}" for name, of in causes]
    chains = [*dict.fromkeys(map(clean, texts))]
    more = [f"and {len(chains) - _SHOWN} more"] if len(chains) > _SHOWN else []
    arrow = "<- " if causes and causes[0][1].path else ""
    return f"  {arrow}{'; '.join([*chains[:_SHOWN], *more])}"


def table(play: Playback) -> Iterator[str]:
    """Yield the lines of a CSV: time, then every named value of the output in each step.

    Kinds whose results explain why they are not to be relied on have columns at the end:
    ``reason``, and ``unknown`` with the ids of inputs, blanks between them.
    """
    for number, (monitor, step) in enumerate(play):
        values = dict(monitor.running.series(step.output))
        if hasattr(step.output, "reason"):
            values.setdefault("reason", str(step.output.reason))
        if hasattr(step.output, "unknown"):
            values.setdefault("unknown", " ".join(step.output.unknown))
        if number == 0:
            yield _csv_line(["t", *values])
        yield _csv_line([repr(step.t), *(_cell(value) for value in values.values())])


def picture(title: str, play: Playback) -> str:
    """Return an SVG of inputs and outputs over time; of several monitors, of their verdicts.

    A claim is drawn as what it asserts, a hazard as its absence: ``NOT overload``.
    """
    groups: dict[str, list[tuple[float, Mapping[str, object]]]] = {}
    reasons: dict[tuple[str, str], list[str]] = {}
    last: dict[tuple[str, str], tuple[object, str]] = {}  # the first reason while it lasts
    for monitor, step in play:
        running, group = monitor.running, monitor.name or "outputs"
        hazards = running.hazards
        outputs = (running.decided if monitor.name else running.series)(step.output)
        values: dict[str, object] = {f"NOT {k}" if k in hazards else k: outputs[k] for k in outputs}
        for id_, why in running.why().items():
            name = f"NOT {id_}" if id_ in hazards else id_
            values[name], key = _HOLDS[why.verdict], (group, name)
            if key not in last or last[key][0] != _first(why):
                last[key] = _first(why), clean(why.causes[0].chain) if why.causes else ""
            reasons.setdefault(key, []).append(last[key][1])
        if not monitor.name:
            groups.setdefault("inputs", []).append((step.t, dict(_single(step.inputs))))
        groups.setdefault(group, []).append((step.t, values))
    tracks = [track for name, rows in groups.items() for track in tracks_of(name, rows)]
    told_of = [tuple(reasons.get((track.group, track.name), ())) for track in tracks]
    pairs = zip(tracks, told_of, strict=True)
    return plot(title, [replace(track, reasons=texts) for track, texts in pairs])


def _single(inputs: Mapping[str, object]) -> Iterator[tuple[str, object]]:
    """Yield the inputs that are no lists."""
    return ((name, v) for name, v in inputs.items() if not isinstance(v, list | tuple))


def _plain(value: object) -> Value:
    """Return a value as JSON has it: NaN is not known, as for the monitor, ``inf`` is a text."""
    if isinstance(value, float) and not math.isfinite(value):
        return None if math.isnan(value) else str(value)
    return value if value is None or isinstance(value, bool | int | float | str) else repr(value)


def _csv_line(cells: Sequence[str]) -> str:
    line = io.StringIO()
    csv.writer(line, lineterminator="").writerow(cells)
    return line.getvalue()


def _cell(value: Value) -> str:
    """Return a value as a recording would have it: an empty cell is unknown."""
    if value is None or isinstance(value, bool):
        return {None: "", True: "true", False: "false"}[value]
    return value if isinstance(value, str) else repr(value)


def _shown(value: Value) -> str:
    if value is None or isinstance(value, bool):
        return {None: "unknown ", True: "active  ", False: "inactive"}[value]
    return f"{value:.4g}" if isinstance(value, float) else str(value)
