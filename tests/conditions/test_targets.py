"""Generated monitors: what they are made of, hand-written bodies, names, sanitizers, callbacks."""

import ast
import math
import random
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings

from eddi_scaffold.common.problems import EddiError
from eddi_scaffold.conditions.analysis import analyse
from eddi_scaffold.conditions.standalone import generate, monitor_model
from eddi_scaffold.program.running import Engine
from eddi_scaffold.program.standalone import keep_in_folder, module_name, unique_names
from tests.conditions import c_program
from tests.conditions.formulas import DECLARATIONS, recording
from tests.data_files import data_text, tabled, write_files
from tests.interpreters import old_python

TEXT = data_text("conditions/demo.events")
EACH = data_text("conditions/each.txt").splitlines()
EVERYTHING = "".join(f"EVENT e{k} (HAZARD) := {text}\n" for k, text in enumerate(EACH))


def analysis_of(text: str, rate: float = 10) -> Any:
    result = analyse(text, rate=rate)
    assert result.program is not None, result.problems
    return result


def module_of(text: str) -> dict[str, Any]:
    ((name, source),) = generate(analysis_of(text), "python", "demo").items()
    names: dict[str, Any] = {"__name__": "demo_event"}
    exec(compile(source, name, "exec", dont_inherit=True), names)
    return names


def test_python_needs_nothing_but_the_standard_library_of_3_8(tmp_path: Path) -> None:
    ((name, source),) = generate(analysis_of(TEXT), "python", "Over Heat").items()
    assert name == "over_heat_event.py"
    tree = ast.parse(source, feature_version=(3, 8))
    imported = {
        node.module if isinstance(node, ast.ImportFrom) else node.names[0].name
        for node in ast.walk(tree)
        if isinstance(node, ast.Import | ast.ImportFrom)
    }
    assert imported <= {"__future__", "math", "time", "bisect", "collections", "typing"}
    titles = [
        line.split(" ", 2)[2].strip("- ") for line in source.split("\n") if line[:5] == "# ---"
    ]
    assert titles == ["1. Variables", "2. Functions", "3. Types", "4. Main"]
    (tmp_path / name).write_text(source)
    program = (
        "import over_heat_event as m\n"
        "class M(m.Monitor):\n"
        "    read_mode = lambda self: 'AUTO'\n"
        "    read_motor_temps_1 = lambda self: m.NumVal(90)\n"
        "    read_motor_temps_1_2 = lambda self: 6\n"
        "    read_class = lambda self: m.BoolVal.true()\n"
        "found = [M().step(k) for k in range(3)][-1]\n"
        "assert repr(found) == \"{'hot': BoolVal.unknown(), 'odd': BoolVal.true()}\", found\n"
    )
    for python in (sys.executable, old_python()):
        done = subprocess.run(
            [python, "-c", program], cwd=tmp_path, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stderr


def test_a_monitor_calls_what_is_raised_and_cleared() -> None:
    names = module_of("VAR x : NUMBER TIMEOUT 250ms EVENT hot (HAZARD) := x > 5")
    calls, samples = [], iter([1, 6, 7, (8, 100), (9, 200), None, 1, "6", True, 10**400])

    class Monitor(names["Monitor"]):
        def read_x(self) -> object:
            return next(samples)

        def on_raised_hot(self, t_ns: int) -> None:
            calls.append(("raised", t_ns))

        def on_cleared_hot(self, t_ns: int) -> None:
            calls.append(("cleared", t_ns))

    monitor = Monitor()
    result = [monitor.step(k * 10**8)["hot"].truth for k in range(10)]
    assert result == [0, 2, 2, 1, 1, 1, 0, 1, 1, 1]
    assert calls == [("raised", 10**8), ("cleared", 3 * 10**8)]
    with pytest.raises(TypeError):
        bool(names["BoolVal"].true())


def test_all_of_c_compiles_and_runs(tmp_path: Path) -> None:
    write_files(tmp_path, generate(analysis_of(TEXT), "c", "demo"))
    sources = [str(tmp_path / name) for name in ("demo_event.c", "demo_main.c")]
    for level in ("-O0", "-O2"):
        c_program.compile_c([level, *sources, "-o", str(tmp_path / "demo"), "-lm"])
    done = subprocess.run([str(tmp_path / "demo")], capture_output=True, text=True, check=True)
    assert done.stdout.split("\n")[:2] == ["hot 1", "odd 1"]


def test_vectors_of_c_tell_a_changed_monitor(tmp_path: Path) -> None:
    """The vectors see a window or a limit that is one unit off, and another operator."""
    text = "VAR x : NUMBER TIMEOUT 300ms EVENT near := ONCE(x < 1.5, 1s) OR AVERAGE(x, 1s) < 3"
    text += " EVENT far (HAZARD) := x > 9"
    files = generate(analysis_of(text), "c", "demo")
    changes = {
        "": "",
        "INT64_C(1000000000)": "INT64_C(1000000001)",
        "INT64_C(900000000)": "INT64_C(900000001)",
        "INT64_C(300000000)": "INT64_C(300000001)",
        "INT64_C(250000000)": "INT64_C(250000001)",
        "v_x, 1.5)": "v_x, 1.5000000000000002)",
        ", 3.0)": ", 2.9999999999999996)",
        "greatest(r3, r6)": "greatest(r3, 2 - r6)",
        "r9, true)": "r9, false)",
    }
    for before, after in changes.items():
        old = files["demo_event.c"]
        assert before in old, before
        write_files(tmp_path, files | {"demo_event.c": old.replace(before, after, 1)})
        sources = [str(tmp_path / name) for name in ("demo_event.c", "demo_vectors.c")]
        c_program.compile_c([*sources, "-o", str(tmp_path / "demo"), "-lm"])
        done = subprocess.run([str(tmp_path / "demo")], capture_output=True, text=True, check=False)
        assert (done.returncode == 0) == (before == ""), (before, done.stdout[:500])
        assert done.returncode == min(len(done.stdout.splitlines()), 100)


def test_a_time_that_no_clock_tells_is_unknown(tmp_path: Path) -> None:
    text = "VAR clear : BOOL TIMEOUT 500ms EVENT go (EVIDENCE) := clear"
    main = """#include "demo_event.h"
#include <stdio.h>
static demo_t m;
int main(void)
{
    demo_reset(&m);
    printf("%d ", (int)demo_step(&m, 1000, 2, INT64_MIN));
    printf("%d ", (int)demo_step(&m, -2000, 2, INT64_MAX));
    printf("%d", (int)demo_step(&m, 1, 2, 1));
    return 0;
}
"""
    write_files(tmp_path, generate(analysis_of(text), "c", "demo") | {"own.c": main})
    sources = [str(tmp_path / name) for name in ("demo_event.c", "own.c")]
    c_program.compile_c([*c_program.SANITIZE, *sources, "-o", str(tmp_path / "demo"), "-lm"])
    done = subprocess.run([str(tmp_path / "demo")], capture_output=True, text=True, check=True)
    assert done.stdout == "1 1 2"


def test_fast_math_is_refused(tmp_path: Path) -> None:
    write_files(tmp_path, generate(analysis_of("x > 5"), "c", "demo"))
    with pytest.raises(AssertionError, match="has no NaN"):
        c_program.compile_c(["-ffast-math", "-c", str(tmp_path / "demo_event.c")])


def test_c_has_neither_undefined_behaviour_nor_differences(tmp_path: Path) -> None:
    steps = 200_000 if settings.default.max_examples > 1000 else 3_000
    analysis = analysis_of(DECLARATIONS + EVERYTHING)
    form = analysis.program
    program = c_program.build(monitor_model(analysis, "all"), tmp_path, "-O1", *c_program.SANITIZE)
    engine = Engine(analysis.program)
    played = [entry for seed in range(20) for entry in recording(random.Random(seed), steps // 20)]
    lines = c_program.run(program, form, played)
    seen: list[set[float]] = [set() for _ in EACH]
    for step, line in zip(played, lines, strict=True):
        values = [step.values[variable.name] for variable in form.reads]
        stamps = [step.stamps.get(variable.name) for variable in form.reads]
        result = engine.step(step.t, values, stamps)
        assert result == tuple(map(int, line.split()))
        seen = [entry | {value} for entry, value in zip(seen, result, strict=True)]
    unchanged = [text for text, entry in zip(EACH, seen, strict=True) if not entry >= {0, 2}]
    assert unchanged == []


def test_an_overflow_is_unknown_until_it_has_left_the_window(tmp_path: Path) -> None:
    """A host that steps 50 times as often as it said fills every buffer."""
    for function in ("MAX", "SUM", "MEDIAN", "STDDEV", "RATE"):
        analysis = analysis_of(f"VAR x : NUMBER TIMEOUT 1h {function}(x, 1s)")
        form, engine = analysis.program, Engine(analysis.program)
        program = c_program.build(monitor_model(analysis, "full"), tmp_path / function)
        t, played, rng = 0, [], random.Random(4)
        for k in range(400):
            t += 2 * 10**6 if 50 <= k < 200 else 10**8
            value = 400.0 - k if function == "MAX" else float(rng.randint(0, 9))
            played.append(c_program.Step(t, {"x": value}, {}))
        lines = c_program.run(program, form, played)
        result = [engine.step(step.t, [step.values["x"]])[0] for step in played]
        in_c = [c_program.as_number(line) for line in lines]
        assert [repr(x) for x in result] == [repr(x) for x in in_c]
        assert all(map(math.isnan, result[100:205])), function
        assert not any(map(math.isnan, result[230:]))


# hand-written code


def written(folder: Path, target: Any, text: str, edits: dict[str, str]) -> None:
    for name, source in generate(analysis_of(text), target, "demo").items():
        edited = source
        for old, new in edits.items():
            edited = edited.replace(old, new)
        (folder / name).write_text(edited)


@tabled
def test_hand_written_bodies_stay(target: Any, old: str, new: str, tmp_path: Path) -> None:
    written(tmp_path, target, "VAR x : NUMBER TIMEOUT 1s x > 5", {old: new})
    files = generate(
        analysis_of("VAR x : NUMBER UNIT m TIMEOUT 2s x > 6 AND RISE(x > 7)"), target, "demo"
    )
    kept, lost = keep_in_folder(files, tmp_path)
    assert lost == []
    joined = "".join(kept.values())
    assert joined.count(new) == 1
    assert "in m" in joined
    # what vanishes is kept beside the files
    files = generate(analysis_of("y > 6"), target, "demo")
    kept, lost = keep_in_folder(files, tmp_path)
    assert len(lost) == 1
    assert kept[lost[0]].startswith("region variable:x\n")
    assert new in kept[lost[0]]


def test_names_are_different_identifiers() -> None:
    names = unique_names(["a.b", "a_b", "a[1]", "0", "a b"])
    assert names == ["a_b", "a_b_2", "a_1", "v_0", "a_b_3"]
    modules = map(module_name, ("Over Heat!", "9", "", "int", "ünï", "size"))
    assert " ".join(modules) == "over_heat event_9 event int_monitor uni size_monitor"


@pytest.mark.parametrize("text", ["# -----Manual edit begin-----  # region: a:b\n", "\udcff"])
def test_files_that_are_not_replaced(text: str, tmp_path: Path) -> None:
    text = f"# generated by eddi-scaffold event\n{text}"
    (tmp_path / "demo_event.py").write_bytes(text.encode("utf-8", "surrogateescape"))
    with pytest.raises(EddiError) as caught:
        keep_in_folder(generate(analysis_of("x > 5"), "python", "demo"), tmp_path)
    assert {problem.code for problem in caught.value.problems} == {"E020"}
