"""Step generated plain packages with random values, and print what they publish as JSON.

Runs in the Python of a robot: ``python replayed.py FOLDER``, where the packages lie.
"""

import ast
import importlib
import json
import random
import sys
from pathlib import Path
from types import SimpleNamespace

STEPS = 300
SECOND = 1_000_000_000
ODD = [None, True, False, 0, 1, -1, 2.5, 1e9, float("nan"), float("inf"), "", [], "odd", (1, 2)]


def constants(text):
    """Return the numbers and texts of a program: among them what its inputs may be."""
    found = [node.value for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Constant)]
    return [one for one in found if isinstance(one, (str, float))]


def value(rng, known):
    """Return a value for an input: now and then an odd one, or a row of a sample."""
    draw = rng.random()
    if draw < 0.1:
        return rng.choice(ODD)
    if draw < 0.3:
        return [rng.gauss(0.0, 1.0) for _ in range(rng.randint(1, 7))]
    if draw < 0.5:
        return rng.random() < 0.8
    if draw < 0.7:
        return rng.uniform(-1.0, 120.0)
    return rng.choice(known)


def replay(package, folder):
    """Yield everything that a monitor publishes and reports in each step."""
    monitor = importlib.import_module(package + ".EDDIMonitor").EDDIMonitor().monitor
    known = constants((folder / package / "compiled.py").read_text("utf-8")) or ODD
    rng = random.Random(package)
    held, t_ns = {}, 0
    for step in range(STEPS):
        for spec in monitor.inputs:
            if rng.random() < 0.4:
                held[spec.attribute] = value(rng, known)
        t_ns += rng.choice([0, SECOND // 10, SECOND, 100 * SECOND, -SECOND])
        if step == STEPS // 2:
            monitor.reset()
        output = monitor.execute_step(SimpleNamespace(**held), t_ns)
        yield [
            monitor.message(output),
            monitor.status_message(),
            monitor.series(output),
            [row.as_json() for row in monitor.why().values()],
            sorted(monitor.faults().items()),
        ]


if __name__ == "__main__":
    place = Path(sys.argv[1])
    sys.path[0] = str(place)
    names = sorted(path.parent.name for path in place.glob("*/EDDIMonitor.py"))
    json.dump({name: list(replay(name, place)) for name in names}, sys.stdout)
