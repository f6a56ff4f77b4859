"""Many damaged inputs, fast: seeded damage without hypothesis, and a watch on time and traces.

Hypothesis shrinks what it finds but takes milliseconds for each example; a hundred thousand inputs
need a plain loop. Each input has a seed of its own, so that one alone can be tried again.
"""

import contextlib
import faulthandler
import math
import re
import signal
import sys
import time
import traceback
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from random import Random

TOKEN = re.compile(rb"[A-Za-z0-9_.]+|[^\sA-Za-z0-9_.]+")
NASTY = [
    *(b"", b"\0", b"\xff", b"\xed\xa0\x80", b"\xef\xbb\xbf", b"\r", b"\t", b"\x1b[31m", b"\x85"),
    *(b"&#0;", b"&#xD800;", b"&amp;", b"&x;", b"]]>", b"<![CDATA[", b"<!--", b"<?x?>", b"</"),
    *(b"<!DOCTYPE x [<!ENTITY x 'y'>]>", b"//@odeProductPackages.0", b"//@odeProductPackages.9"),
    *(b"xsi:type", b"href", b"consert_:NumericDimension", b"AND", b"OR", b"xmlns:consert_"),
    *(b"1e999", b".nan", b".inf", b"-1", b"0", b"1_000", b"99999999999999999999", b"1e-400"),
    *(b"*a", b"&a [*a]", b"!!python/object/apply:os.system", b"<<", b"?", b"|", b">", b"%", b"="),
    *(b"null", b"true", b"off", b"{}", b"[]", b"[", b"]", b"{", b"}", b": ", b"- ", b"#", b"---\n"),
    *(b"'''", b'"""', b"'", b'"', b"\\", b"{{ 7*7 }}", b"{% raw %}", b"$(arg x)", b"../../x", b"/"),
    *("\u2028".encode(), "ü💥".encode(), b" " * 40, b"\n" * 3, b"\n  ", b"a" * 5000),
]  # fmt: skip
LARGEST = 150_000
"""Bytes of the largest damaged input; what is behind is cut off."""
PATIENCE = 60
"""Seconds after which, at the latest, a call that does not return to Python ends the process."""
WOUND = 10
"""Seconds between two windings of that clock, which starts a thread each time."""
LONG = [
    *(b"[" * 3000, b"(" * 3000, b"{a: " * 2000, b"<a>" * 5000, b"-" * 100_000, b"~" * 100_000),
    *(b"not " * 20_000, b"NOT " * 20_000, b"9" * 20_000, b"0x" + b"f" * 20_000, b"1_" * 20_000),
    *(b"0b" + b"1" * 20_000, b"1" + b":59" * 20_000, b" " * 50_000, b"\n" * 50_000, b"\t" * 50_000),
    *(b"a" * 100_000, b"a." * 30_000, b"a, " * 20_000, b"a\n" * 20_000, b"- a\n" * 10_000),
    *(b"//@a.0" * 10_000, b"/@a.0" * 10_000, b"&amp;" * 10_000, b'"' * 30_000, b"'" * 30_000),
    *(b"x = 1\n" * 5000, b"# x\n" * 10_000, b"if a:\n" * 500, b"\\\n" * 10_000, b"1+" * 30_000),
]  # fmt: skip
"""What a recursion, a quadratic loop or a backtracking pattern does not get through."""


@dataclass(frozen=True)
class Sample:
    """A sound input."""

    name: str
    data: bytes


@dataclass(frozen=True)
class Reader:
    """What reads damaged inputs."""

    name: str
    samples: Sequence[Sample]
    attempt: Callable[[Sample], Iterator[None]]


@dataclass
class Fault:
    """What went wrong, with the first input that shows it."""

    reader: str
    what: str
    seed: str
    sample: Sample
    trace: str
    count: int = 1

    def __str__(self) -> str:
        return f"{self.reader}: {self.what} ({self.count} times), first {self.seed}\n{self.trace}"


@dataclass
class Result:
    """What a run found."""

    inputs: int = 0
    seconds: float = 0.0
    slowest: float = 0.0
    faults: dict[str, Fault] = field(default_factory=dict)


class HangError(BaseException):
    """Too long for one input; no reader catches it."""


def damaged(data: bytes, chance: Random) -> bytes:
    """Return the bytes with one to five pieces of damage."""
    for _ in range(chance.randint(1, 5)):
        data = _damaged_once(data, chance) if data else data
    return data[:LARGEST]


def _damaged_once(data: bytes, chance: Random) -> bytes:
    kind = chance.choice(_KINDS)
    at = chance.randrange(len(data))
    if kind == "flip":
        return data[:at] + bytes([chance.randrange(256)]) + data[at + 1 :]
    if kind == "cut":
        return data[:at] + data[at + chance.randint(1, 60) :]
    if kind == "insert":
        return data[:at] + _piece(chance) + data[at:]
    if kind == "end":
        return data[:at]
    if kind == "repeat line":
        lines = data.splitlines(keepends=True)
        line = at % len(lines)
        again = [lines[line]] * chance.choice((1, 1, 2, 3, 3, 300))
        return b"".join([*lines[: line + 1], *again, *lines[line + 1 :]])
    tokens = list(TOKEN.finditer(data))
    if not tokens:
        return data
    first, second = chance.choices(tokens, k=2)
    if kind == "replace":
        new = _piece(chance) if chance.random() < 0.5 else second.group()
        return data[: first.start()] + new + data[first.end() :]
    if first is second:
        return data
    first, second = sorted((first, second), key=re.Match.start)
    middle = data[first.end() : second.start()]
    return data[: first.start()] + second.group() + middle + first.group() + data[second.end() :]


_KINDS = ("flip", "cut", "insert", "swap", "replace", "replace", "repeat line", "end")


def _piece(chance: Random) -> bytes:
    if chance.random() < 0.02:
        return chance.choice(LONG)
    return chance.choice(NASTY) if chance.random() < 0.8 else chance.randbytes(chance.randrange(9))


def fuzz(reader: Reader, seed: str, count: int, limit: float) -> Result:
    """Try ``count`` damaged inputs."""
    result = Result()
    began, wound = time.monotonic(), -math.inf
    with _ended():
        for number in range(count):
            if time.monotonic() - wound > WOUND:
                wound = _wind()
            one = f"{seed}:{number}"
            _try(reader, one, damaged_sample(reader, one), limit, result)
    result.inputs, result.seconds = count, time.monotonic() - began
    return result


def damaged_sample(reader: Reader, seed: str) -> Sample:
    """Return the damaged input of a seed."""
    chance = Random(seed)
    sound = chance.choice(reader.samples)
    return Sample(sound.name, damaged(sound.data, chance))


def _try(reader: Reader, seed: str, sample: Sample, limit: float, result: Result) -> None:
    patience = limit * max(1.0, len(sample.data) / 100_000)
    steps = reader.attempt(sample)
    try:
        while True:
            start = time.process_time()
            with _limited(patience):
                next(steps)
            result.slowest = max(result.slowest, time.process_time() - start)
    except StopIteration:
        return
    except (Exception, HangError) as failed:  # noqa: BLE001 - whatever it is, it is noted
        _note(result, reader, seed, sample, failed)


def _note(result: Result, reader: Reader, seed: str, sample: Sample, failed: BaseException) -> None:
    frames = traceback.extract_tb(failed.__traceback__)
    around = [frame for frame in frames if frame.filename != __file__]
    own = [frame for frame in around if "eddi_" in frame.filename] or around
    at = own[-1]
    file = at.filename.rpartition("/")[2]
    what = f"{type(failed).__name__} in {file}:{at.lineno}"
    if isinstance(failed, (HangError, RecursionError)):  # it may be anywhere in a loop
        what = f"{type(failed).__name__} in {file}:{at.name}"
    if what in result.faults:
        result.faults[what].count += 1
        return
    trace = "".join(traceback.format_exception(failed)[-12:])
    result.faults[what] = Fault(reader.name, what, seed, sample, trace[-4000:])


@contextlib.contextmanager
def watched(limit: float) -> Iterator[None]:
    """Raise in what takes longer; what does not come back from C ends the process."""
    with _ended(), _limited(limit):
        yield


@contextlib.contextmanager
def _limited(limit: float) -> Iterator[None]:
    before = signal.signal(signal.SIGPROF, _ring)
    signal.setitimer(signal.ITIMER_PROF, limit)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)


@contextlib.contextmanager
def _ended() -> Iterator[None]:
    _wind()
    try:
        yield
    finally:
        faulthandler.cancel_dump_traceback_later()


def _wind() -> float:
    faulthandler.dump_traceback_later(PATIENCE, exit=True, file=sys.__stderr__)
    return time.monotonic()


def _ring(*_: object) -> None:
    raise HangError
