"""Random events over fixed variables, and random recordings full of what goes wrong."""

import math
import random
from dataclasses import dataclass

from eddi_scaffold.program.instructions import Read
from tests.data_files import data_text

RATE = 10
PERIOD = 10**8
DECLARATIONS = data_text("conditions/formulas.events")
_LONG = 1000 * 3600 * 10**9
READS = (
    Read("x", "number", timeout=_LONG, stamped=True),
    Read("y", "number", range=(-6.0, 6.5), timeout=_LONG, stamped=True),
    Read("z.range[0]", "number", infinite=True, timeout=_LONG, stamped=True),
    Read("w", "number", timeout=350 * 10**6, stamped=True),
    Read("a", "bool", timeout=_LONG, stamped=True),
    Read("b", "bool", timeout=250 * 10**6, stamped=True),
    Read("m", "enum", timeout=_LONG, literals=("AUTO", "MANUAL", "OFF"), stamped=True),
)
NUMBERS = ("x", "y", "z.range[0]", "w")
TRUTHS = ("a", "b")
NUMERIC_WINDOWS = ("AVERAGE", "SUM", "MAX", "MIN", "MEDIAN", "STDDEV", "RATE")


@dataclass
class Formulas:
    random: random.Random
    monotone: bool = False

    def boolean(self, depth: int) -> str:
        pick = self.random.choice
        if depth <= 0:
            return pick([*TRUTHS, *TRUTHS, "(m == AUTO)", "(m != OFF)", pick(["TRUE", "FALSE"])])
        inner = depth - 1
        kind = self.random.randrange(14)
        if kind < 4:
            sign = pick(["<", "<=", ">", ">=", "==", "!="])
            return f"({self.number(inner)} {sign} {self.number(inner)})"
        if kind < 7:
            word = pick(["AND", "OR", "XOR", "IMPLIES", "==", "!="])
            return f"({self.boolean(inner)} {word} {self.boolean(inner)})"
        if kind == 7:
            return f"(NOT {self.boolean(inner)})"
        if kind < 10:
            return f"{pick(['TIME', 'ONCE'])}({self.boolean(inner)}, {self.duration()})"
        if kind == 10:
            return f"{pick(['RISE', 'FALL', 'EDGE'])}({self.boolean(inner)})"
        if kind == 11:
            return f"LATCH({self.boolean(inner)}, {self.boolean(inner)})"
        if kind == 12 or self.monotone:
            low = self.random.randint(-4, 2)
            return f"HYSTERESIS({self.number(inner)}, {low}, {low + self.random.randint(1, 4)})"
        known = pick([self.number(inner), self.boolean(inner), "m"])
        return f"KNOWN({known})"

    def number(self, depth: int) -> str:
        pick = self.random.choice
        if depth <= 0:
            return pick([*NUMBERS, *NUMBERS, "0", "1", "2.3171", "0.5", "3", "1e200"])
        inner = depth - 1
        kind = self.random.randrange(10)
        if kind < 3:
            return f"({self.number(inner)} {pick(['+', '-', '*', '/'])} {self.number(inner)})"
        if kind == 3:
            more = f"{pick(['LEAST', 'GREATEST', 'HYPOT'])}({self.number(inner)}, {self.number(0)})"
            clamped = f"CLAMP({self.number(inner)}, -1, 2.5)"
            return pick(
                (
                    *(f"(-{self.number(inner)})", f"ABS({self.number(inner)})", more, clamped),
                    f"SQRT({self.number(inner)})",
                )
            )
        if kind < 8:
            function = pick(NUMERIC_WINDOWS)
            return f"{function}({self.number(inner)}, {self.duration()}{self.coverage()})"
        if kind == 8:
            return f"COUNT({self.boolean(inner)}, {self.duration()}{self.coverage()})"
        if self.monotone:
            return f"ELAPSED({self.boolean(inner)})"
        return pick([f"ELAPSED({self.boolean(inner)})", f"AGE({pick(NUMBERS)})", "AGE(b)"])

    def duration(self) -> str:
        return self.random.choice(["100ms", "150ms", "200ms", "0.5s", "730ms", "1s", "2s", "4s"])

    def coverage(self) -> str:
        if self.monotone or self.random.random() < 0.7:
            return ""
        return f", COVERAGE {self.random.choice(['0.25', '0.5', '0.8', '1'])}"


@dataclass(frozen=True)
class Step:
    t: int
    values: dict[str, object]
    stamps: dict[str, int]


def recording(rng: random.Random, steps: int) -> list[Step]:
    t, result = rng.randint(-(10**10), 10**10), []
    trouble = rng.choice([0.0, 0.03, 0.25])
    for _ in range(steps):
        kind = rng.random()
        if kind < 0.7:
            t += PERIOD
        elif kind < 0.9:
            t += rng.choice([PERIOD - 3 * 10**7, PERIOD + 3 * 10**7, PERIOD // 2 + 1])
        elif kind < 0.94:
            t += rng.choice([250 * 10**6, 250 * 10**6 + 1, 10 * PERIOD])
        elif kind < 0.96:
            t -= rng.choice([0, 0, 1, 5 * PERIOD])
        else:
            t += PERIOD
        values = {name: number(rng, trouble) for name in NUMBERS}
        values |= {n: rng.choice([True, False]) for n in TRUTHS}
        values["m"] = rng.choice(["AUTO", "MANUAL", "OFF"])
        for name in (*TRUTHS, "m"):
            if rng.random() < trouble:
                values[name] = rng.choice([None, "BROKEN", 1, math.nan])
        stamps = {"w": t - rng.choice([0, 0, 0, 10**8, 350 * 10**6, 350 * 10**6 + 1])}
        stamps["b"] = t + rng.choice([0, 0, -2 * 10**8, -3 * 10**8, 10**7, PERIOD, 2 * PERIOD])
        result.append(Step(t, values, stamps))
    return result


def number(rng: random.Random, trouble: float) -> object:
    if rng.random() < trouble:
        return rng.choice([None, math.nan, math.inf, -math.inf, 100.0, 1e200, True, "x", 1e-200])
    return rng.choice(
        [float(rng.randint(-5, 5)), rng.randint(-8, 8) / 2, round(rng.gauss(1, 3), 3)]
    )
