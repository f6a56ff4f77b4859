"""The C of monitors is compared with what was read: it is what is generated, and no other text."""

import random
import re
from pathlib import Path

import pytest

from eddi_scaffold.conditions.analysis import analyse
from eddi_scaffold.conditions.standalone import monitor_model
from eddi_scaffold.evidence.c_text import difference
from eddi_scaffold.program.c_files import c_files, library, types
from eddi_scaffold.program.standalone import StandaloneMonitor, named
from tests.cli.command import edit, run
from tests.conditions.test_targets import DECLARATIONS, EVERYTHING
from tests.program.test_conserts_in_c import SETTINGS, random_consert

CONDITIONS = (
    DECLARATIONS + EVERYTHING,
    "VAR x : NUMBER TIMEOUT 300ms AVERAGE(x, 1s)",
    "ENUM Mode {A, B} VAR R1 : Mode EVENT K := R1 == A AND KNOWN(R1)",
    (
        "VAR y : NUMBER VAR z : NUMBER "
        "VAR x : NUMBER RANGE -5 .. 50 TIMEOUT 1 s MAX(x, 1s) / y + SQRT(z) - MEDIAN(x, 2s)"
    ),
    "VAR x : NUMBER ALLOW INF EVENT a := COUNT(x > 3, 2s) > 2 EVENT b (HAZARD) := AGE(x) > 1",
    "EVENT e := AVERAGE(x, 1s, COVERAGE 0.5) > 2",
)


def models() -> list[StandaloneMonitor]:
    read = [analyse(text, rate=10, name="t") for text in CONDITIONS]
    made = [monitor_model(of, f"m{k}") for k, of in enumerate(read)]
    for k, settings in enumerate(SETTINGS):
        program = random_consert(random.Random(k), settings)[0].compiled().program
        made.append(named(program, f"c{k}", ["a ConSert"], kind="consert"))
    return made


def differs(model: StandaloneMonitor, files: dict[str, str]) -> tuple[str, int, str] | None:
    return difference(model, files, types(), library())


@pytest.mark.parametrize("model", models(), ids=lambda of: of.name)
def test_no_other_text_is_proved(model: StandaloneMonitor) -> None:
    files, rng = c_files(model), random.Random(model.name)
    assert differs(model, files) is None
    for suffix in "hc":
        name = f"{model.name}_{model.kind}.{suffix}"
        text = files[name]
        comments = [range(*of.span()) for of in re.finditer(r"/\*.*?\*/", text, re.DOTALL)]
        code = [k for k, c in enumerate(text) if not c.isspace()]
        for k in rng.sample(code, min(200, len(code))):
            letter = rng.choice("0129abr+-<>=!&|;(){}")
            if text[k] != letter and not any(k in comment for comment in comments):
                changed = files | {name: f"{text[:k]}{letter}{text[k + 1 :]}"}
                found = differs(model, changed)
                assert (found or [""])[0] == name, changed[name][k - 40 : k + 40]
        lines = text.split("\n")
        for k in rng.sample(range(len(lines)), min(30, len(lines))):
            plain = re.sub(r"/\*.*?\*/", "", lines[k]).strip()
            if re.match(r"(m->|r\d|publish|if|start|return)", plain):
                assert differs(model, files | {name: "\n".join(lines[:k] + lines[k + 1 :])}), plain


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("    m->last = t;", "    /* x *\\\n/ m->last = 0; /* y */"),
        ("    m->last = t;", "    /* x *??/\n/ m->last = 0; /* y */"),
        ("#ifdef __FAST_MATH__\n", "#ifdef __FAST_MATH__ /*\n*/"),
        ("#ifdef __FAST_MATH__", "#ifdef __FAST_/**/MATH__"),
        ("#include <math.h>", "#include <math.h>\n/* */ #define isnan(x) 0"),
        ("static int least(int a, int b)\n{\n    return a < b ? a : b;\n}\n", ""),
    ],
)
def test_what_only_looks_like_a_comment_is_none(old: str, new: str) -> None:
    model = monitor_model(analyse("x > 3 AND y > 2", rate=10, name="t"), "demo")
    files = c_files(model)
    text = files["demo_event.c"]
    assert old in text
    assert differs(model, files | {"demo_event.c": text.replace(old, new)}) is not None


def test_a_changed_line_has_its_place(tmp_path: Path) -> None:
    words = ["event", "AVERAGE(temp, 5s) > 100", "--rate", "10", "--target", "c", "-o", "monitor"]
    assert run(*words, cwd=tmp_path).status == 0
    same = run(*words, "--check", cwd=tmp_path)
    names = "event_main.c and event_vectors.c"
    told = f"event_event.h, event_event.c: proved; not looked at: {names}\n"
    assert (same.status, same.out) == (0, told)
    edit(tmp_path / "monitor/event_event.c", "less(100.0, r1)", "less(100.5, r1)")
    other = run(*words, "--check", cwd=tmp_path)
    line = "differs: 'r3 = less(100.5, r1);', the model says 'r3 = less(100.0, r1);'\n"
    assert other.status == 1
    assert re.fullmatch(rf"monitor/event_event.c:\d+: {re.escape(line)}", other.out)
