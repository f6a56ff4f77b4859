"""The catalogue of diagnostics: each call names a case of it and gives its fields; all are used."""

from __future__ import annotations

import ast
import re
from collections import defaultdict
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path
from string import Formatter

import pytest

from eddi_scaffold.common.catalogue import FOLDER, Diagnostic, areas, case_of, find

ROOT = Path(__file__).parents[1]
NAME = re.compile(r"[A-Z]\d{3}(\..*)?")
SHARED = re.compile(r"\.[a-z]+")
ALL = [diagnostic for area in areas() for diagnostic in area.diagnostics.values()]
CASES = [f"{diagnostic.code}.{case}".rstrip(".") for diagnostic in ALL for case in diagnostic.cases]
REPORTERS = {"problem", "report", "_report", "add", "refuse", "count", "_fail", "_fault", "fault"}
REPORTERS |= {"_Wrong"}
"""What takes a case and its fields."""


@cache
def modules() -> list[tuple[str, list[ast.AST]]]:
    """Return the name of each module with all that is written in it."""
    paths = (ROOT / "eddi_scaffold").rglob("*.py")
    trees = ((str(path.relative_to(ROOT)), ast.parse(path.read_text("utf-8"))) for path in paths)
    return [(path, [*ast.walk(tree)]) for path, tree in trees]


def named_in(parts: Iterable[ast.AST]) -> Iterator[str]:
    for part in parts:
        if isinstance(part, ast.Constant) and NAME.fullmatch(str(part.value)):
            yield part.value


def calls(nodes: Iterable[ast.AST]) -> Iterator[tuple[ast.Call, str]]:
    """Yield each call that names a case with which something is reported."""
    for call in nodes:
        if isinstance(call, ast.Call) and call.args:
            function = getattr(call.func, "attr", getattr(call.func, "id", ""))
            if function in REPORTERS and isinstance(call.args[0], ast.Constant | ast.IfExp):
                yield from ((call, name) for name in named_in(ast.walk(call.args[0])))


def fields_of(name: str) -> set[str]:
    _, text, hint = case_of(name)
    parts = [part for template in (text, hint or "") for part in Formatter().parse(template)]
    return {field for _, field, _, _ in parts if field is not None}


def test_a_call_gives_the_fields_of_its_case() -> None:
    wrong = []
    for path, nodes in modules():
        for call, name in calls(nodes):
            if name not in CASES:
                wrong.append(f"{path}:{call.lineno}: there is no case {name}")
                continue
            keywords = [keyword.arg for keyword in call.keywords]
            fields = {keyword for keyword in keywords if keyword not in (None, "hint")}
            if None not in keywords and fields != fields_of(name):
                wrong.append(f"{path}:{call.lineno}: {name} has the fields {fields_of(name)}")
            if "hint" in keywords and case_of(name).hint is not None:
                wrong.append(f"{path}:{call.lineno}: {name} has a hint")
    assert not wrong, "\n".join(wrong)


def test_each_case_is_used() -> None:
    used: set[str] = set()
    codes: dict[str, set[str]] = defaultdict(set)
    for path, nodes in modules():
        for name in named_in(nodes):
            used.add(name)
            codes[name.partition(".")[0]].add(path)
        for text in nodes:  # f"{code}.encoding": the code comes from the caller
            if isinstance(text, ast.JoinedStr) and isinstance(text.values[-1], ast.Constant):
                case = text.values[-1].value
                if SHARED.fullmatch(case) and len(text.values) == 2:
                    used |= {name for name in CASES if name.endswith(case)}
    assert not set(CASES) - used
    assert set(codes) == {diagnostic.code for diagnostic in ALL}


@pytest.mark.parametrize("diagnostic", ALL, ids=lambda diagnostic: diagnostic.code)
def test_a_code_is_explained(diagnostic: Diagnostic) -> None:
    assert diagnostic.title
    for text in (diagnostic.why, diagnostic.fix):
        assert text.endswith((".", "?"))
    assert "" not in diagnostic.cases or len(diagnostic.cases) == 1
    for name, case in diagnostic.cases.items():
        assert case.level in ("error", "warning", "info")
        fields = fields_of(f"{diagnostic.code}.{name}".rstrip("."))
        assert all(field.isidentifier() for field in fields), "a field is a name, not a path"


def test_one_file_for_each_letter() -> None:
    for path, area in zip(sorted(FOLDER.glob("*.toml")), areas(), strict=True):
        codes = list(area.diagnostics)
        assert path.stem == area.letter
        assert codes == sorted(codes)
        assert {code[0] for code in codes} == {area.letter}


def test_documents_name_codes_that_there_are() -> None:
    for path in (ROOT / "README.md", *(ROOT / "docs").rglob("*.md")):
        text = path.read_text("utf-8")
        # codes of other tools
        text = re.sub(r"(?m)^\| (flake8|pep257) \|.*|--select [\w,]+", "", text)
        for code in re.findall(r"\b[A-Z]\d{3}\b", text):
            diagnostic = find(code)
            assert diagnostic is not None, (path.name, code)
            assert diagnostic.code == code, (path.name, code)
