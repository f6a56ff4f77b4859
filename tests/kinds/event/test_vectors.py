"""Vectors of events: every mutant of a package is killed or proved equal; random events pass."""

import ast
import json
import math
import re
from difflib import ndiff
from pathlib import Path

import pytest
from eddi_runtime.testing import failures

from eddi_scaffold.monitors.answers import VECTORS, files_of
from eddi_scaffold.packages.assembly import monitors_of
from tests.conditions.test_agreement import batches, text_of
from tests.kinds.consert.test_vectors import Package, input_class, names_only

GAP = r"if 2 \* \(t - last\) > (\d+):"


def is_proved(text: str, before: str, after: str) -> bool:
    """Return whether a changed line of the lidar's step is the same for every input.

    Each way is an argument: identity and equality are one for None and types; there is one window;
    twice a whole number is never odd; a comparison with constants depends only on the order of its
    number and these, and ONCE sees of a truth whether it is 2 and whether it is 1.
    """
    if (" None " in before or "type(" in before) and after.replace("!=", "is not") == before:
        return True
    if text.count("Hold(") == 1 and after.replace("windows[-1]", "windows[0]") == before:
        return True
    ends = [re.fullmatch(GAP, line) for line in (before, after)]
    if all(ends):
        low, high = (int(end[1]) for end in ends)
        return low // 2 == high // 2
    (old,), (new,) = ast.parse(before).body, ast.parse(after).body
    if not (isinstance(old, ast.Assign) and old.targets[0].id == "r2"):
        return False
    assert len(re.findall(r"\br2\b", text)) == 2
    assert "self.w3(t, age, r2)" in text
    constants = {float(number) for number in re.findall(r"[0-9]+\.[0-9]+", before + after)}
    near = {math.nextafter(number, end) for number in constants for end in (-math.inf, math.inf)}
    between = {(a + b) / 2 for a in constants for b in constants}
    for nearest in {*constants, *near, *between, math.inf, -math.inf, math.nan}:
        values = [
            eval(ast.unparse(row.value), {"nearest": nearest, "NAN": math.nan})
            for row in (old, new)
        ]
        if [values[0] == 2, values[0] == 1] != [values[1] == 2, values[1] == 1]:
            return False
    return True


@pytest.mark.filterwarnings("ignore::SyntaxWarning")
def test_each_mutant_is_killed_or_proved_equal(tmp_path: Path) -> None:
    package = Package("lidar", None, "warehouse-robot/robot.yml", tmp_path)
    survivors, killed = package.survivors()
    assert killed >= 140
    original, lines = package.class_of(package.body), ast.unparse(ast.parse(package.body))
    for text in survivors:
        changes = ndiff(lines.splitlines(), text.splitlines())
        before, after = (line[1:].strip() for line in changes if line[0] in "-+")
        is_same = names_only(text, package.class_of(text), original)
        assert is_same or is_proved(lines, before, after), (before, after)


def test_random_events_pass(tmp_path: Path) -> None:
    for seed in range(3 * batches()):
        file = tmp_path / f"e{seed}.events"
        file.write_text(text_of(seed, count=2))
        files = files_of(monitors_of(file, [])[0][0])
        scope = {"__name__": "compiled", "__file__": "no file"}
        exec(files["compiled.py"].decode(), scope)
        vectors = tmp_path / "vectors.json"
        vectors.write_bytes(files[VECTORS])
        assert json.loads(files[VECTORS])["runs"]
        assert failures(str(vectors), scope["Monitor"], input_class(scope["Monitor"])) == []
