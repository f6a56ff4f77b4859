"""The registry of diagnostics: it has each code that is raised, with an example that is run."""

from __future__ import annotations

import ast
import re
import runpy
from collections import defaultdict
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from eddi_scaffold.common.catalogue import AREAS, Diagnostic, areas, find, parse_area

ROOT = Path(__file__).parents[1]
NOT_YET = ""
"""Letters of areas that are still to be written."""
SCRIPT: dict[str, Any] = runpy.run_path(str(ROOT / "script" / "diagnostics.py"))
ALL = [one for area in areas() for one in area.diagnostics]
CODE = re.compile(r"[A-Z]\d{3}")
LEVELS = {"error": "error", "warning": "warning", "warn": "warning", "info": "info"}


def modules() -> Iterator[ast.AST]:
    for path in (ROOT / "eddi_scaffold").rglob("*.py"):
        if path.parent != AREAS.parent:
            yield ast.parse(path.read_text("utf-8"))


@cache
def raised() -> frozenset[str]:
    texts = (node.value for tree in modules() for node in ast.walk(tree) if _is_text(node))
    return frozenset(text for text in texts if CODE.fullmatch(text))


def _is_text(node: ast.AST) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, str)


@cache
def snapshots() -> str:
    return "\n".join(SCRIPT["snapshots"]())


@cache
def levels() -> dict[str, set[str]]:
    """Return code -> levels, as functions named after them are called and as they are printed."""
    found: dict[str, set[str]] = defaultdict(set)
    for tree in modules():
        for call in ast.walk(tree):
            if isinstance(call, ast.Call) and call.args and _is_text(call.args[0]):
                name = getattr(call.func, "attr", getattr(call.func, "id", "")).lstrip("_")
                if name in LEVELS:
                    found[call.args[0].value].add(LEVELS[name])
                elif name == "count" and len(call.args) > 1 and _is_text(call.args[1]):
                    found[call.args[1].value].add(LEVELS[call.args[0].value])
    for level, code in re.findall(r"(?m)(error|warning|info): .* \[([A-Z]\d{3})\]$", snapshots()):
        found[code].add(level)
    return found


def test_what_is_raised_is_what_is_known() -> None:
    wanted = {code for code in raised() if code[0] not in NOT_YET}
    assert len(raised()) > 280
    assert wanted == {one.code for one in ALL}


def test_one_letter_for_each_area() -> None:
    for path, area in zip(sorted(AREAS.glob("*.md")), areas(), strict=True):
        codes = [one.code for one in area.diagnostics]
        assert path.stem == area.letter
        assert codes == sorted(set(codes))
        assert {code[0] for code in codes} == {area.letter}
    assert len({area.title for area in areas()}) == len(areas())


@pytest.mark.parametrize("one", ALL, ids=lambda one: one.code)
def test_a_code_is_explained(one: Diagnostic) -> None:
    for text in (one.why, one.what_to_do):
        assert text.endswith((".", "?"))
    assert levels()[one.code] <= set(one.levels)
    proved = f'assert_example("{one.code}"' in own_proofs()
    assert proved or levels()[one.code] == set(one.levels)
    assert proved or stripped(one.example) in stripped(snapshots())
    assert f"[{one.code}]" in one.example or f'"code": "{one.code}"' in one.example


@cache
def own_proofs() -> str:
    paths = (ROOT / "tests").rglob("test_*.py")
    return "\n".join(path.read_text("utf-8") for path in paths)


@cache
def stripped(text: str) -> str:
    return "\n".join(line.strip() for line in text.splitlines())


def test_the_page_is_up_to_date() -> None:
    assert (ROOT / "docs" / "reference" / "diagnostics.md").read_text("utf-8") == SCRIPT[
        "document"
    ]()
    known = SCRIPT["printed"]()
    for path in AREAS.glob("*.md"):
        text = path.read_text("utf-8")
        assert SCRIPT["with_examples"](text, known).rstrip() == text.rstrip()


def test_documents_name_codes_that_there_are() -> None:
    pages = {ROOT / "README.md", *(ROOT / "docs").rglob("*.md")}
    for path in pages - {ROOT / "docs" / "reference" / "diagnostics.md"}:
        text = path.read_text("utf-8")
        text = re.sub(r"(?m)^\| (flake8|pep257) \|.*", "", text)  # codes of other tools
        for code in re.findall(r"\b[A-Z]\d{3}\b", text):
            assert code[0] in NOT_YET or find(code) is not None, (path.name, code)


@pytest.mark.parametrize(
    "text", ["K: no hash\n", "# K: title\n\nabout\n\n## K001 title\n\n*error*\n\nonly one text\n"]
)
def test_a_damaged_area_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r"^no "):
        parse_area(text)
