"""The digest by which robots know a model: what computes something else has another one."""

import json
import re
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, make_dataclass
from fractions import Fraction
from pathlib import Path
from random import Random
from typing import Any

import pytest
import yaml

from eddi_scaffold.common.problems import Place
from eddi_scaffold.monitors.compiling import digest_of
from eddi_scaffold.program.input_expressions import BoundInput
from eddi_scaffold.program.instructions import Operation
from tests.cli.command import run
from tests.data_files import tabled, write_files
from tests.frozen import corpus
from tests.frozen.random_models import MAKERS
from tests.frozen.texts import REFUSED, compiled_text, computed_by, parts_of

EDITS = 8
"""Of one model in a run."""
_TOKEN = re.compile(r"[A-Za-z_]\w*|\d+(?:\.\d+)?")


@pytest.fixture(autouse=True)
def no_pgmpy(monkeypatch: pytest.MonkeyPatch) -> None:
    """Leave out the comparison with pgmpy, which takes long."""
    monkeypatch.setitem(sys.modules, "pgmpy", None)


def compiled(folder: Path) -> tuple[str, str] | None:
    """Return the digest of a compiled monitor, and what it computes: its text without comments."""
    configs = corpus.configurations(folder)
    words = ("-c", *configs) if configs else ("-m", *corpus.models(folder))
    result = run("answers", *words, "-o", "answers.yml", "--platform", "plain", cwd=folder)
    if result.status == REFUSED:
        return None
    answers = yaml.load((folder / "answers.yml").read_text("utf-8"), yaml.CSafeLoader)
    digest = json.loads(answers["facts"])["model"]["digest"]
    return digest, computed_by(parts_of(compiled_text(answers))["body"])


def edited(files: Mapping[str, str], rng: Random) -> Mapping[str, str]:
    """Return files in which one number or word is another one, or one line is gone."""
    name = rng.choice(sorted(files))
    text = files[name]
    tokens = list(_TOKEN.finditer(text))
    token = rng.choice(tokens)
    if rng.random() < 0.15:
        lines = text.splitlines(keepends=True)
        del lines[rng.randrange(len(lines))]
        return {**files, name: "".join(lines)}
    other = rng.choice([one[0] for one in tokens if one[0][0].isdigit() == token[0][0].isdigit()])
    if token[0].isdigit() and rng.random() < 0.5:
        other = str(int(token[0]) + 1)
    return {**files, name: text[: token.start()] + other + text[token.end() :]}


def models(kind: str) -> Iterator[tuple[int, Mapping[str, str]]]:
    for number in range(6):
        files = MAKERS[kind](number)
        if not any(len(re.findall("<ConSert |<FaultTree ", text)) > 1 for text in files.values()):
            yield number, files


@pytest.mark.slow
@pytest.mark.parametrize("kind", MAKERS)
def test_monitors_that_differ_have_different_digests(kind: str, tmp_path: Path) -> None:
    computed: dict[str, str] = {}
    for number, files in models(kind):
        rng = Random(f"{kind} {number}")
        for edit in range(EDITS):
            changed = edited(files, rng) if edit else files
            monitor = compiled(write_files(tmp_path / f"{number}-{edit}", changed))
            if monitor is not None:
                digest, text = monitor
                assert computed.setdefault(digest, text) == text, (number, edit)
    assert len(computed) > EDITS // 2


@pytest.mark.slow
@pytest.mark.parametrize("kind", MAKERS)
def test_lines_that_move_and_comments_change_no_digest(kind: str, tmp_path: Path) -> None:
    comments = {".yml": "# moved\n\n", ".events": "// moved\n\n", ".csv": "# moved\n"}
    compared = 0
    for number, files in models(kind):
        moved = {
            name: f"{comments.get(Path(name).suffix, '')}{text}\n" for name, text in files.items()
        }
        before = compiled(write_files(tmp_path / f"{number}", files))
        if before is not None:
            after = compiled(write_files(tmp_path / f"{number}-moved" / "elsewhere", moved))
            assert after == before, number
            compared += 1
    assert compared > 2


@dataclass(frozen=True)
class Options:
    limits: tuple[Fraction, ...]
    names: frozenset[str] = frozenset()
    description: str = ""
    derived: int = field(default=0, compare=False)
    place: Place | None = None


def test_what_decides_nothing_is_left_out() -> None:
    options = Options((Fraction(1, 3),))
    about = Options((Fraction(1, 3),), description="a", derived=1, place=Place("b.yml", 2))
    assert digest_of(about) == digest_of(options)
    assert digest_of(Options((Fraction(1, 3),), frozenset({"a"}))) != digest_of(options)


def test_a_new_field_with_a_default_changes_no_digest() -> None:
    fields: list[Any] = [("limits", tuple[Fraction, ...]), ("added", float, 1.0)]
    newer = make_dataclass("Options", fields, frozen=True)
    old = digest_of(Options((Fraction(1, 3),)))
    assert (digest_of(newer((Fraction(1, 3),))) == old, digest_of(newer((), 2.0)) == old) == (
        True,
        False,
    )


@tabled
def test_each_property_of_an_input_counts(change: Mapping[str, Any]) -> None:
    inputs = BoundInput("a", "a"), BoundInput(**{"id": "a", "attribute": "a", **change})
    before, after = (digest_of(input_) for input_ in inputs)
    assert before != after


def test_an_element_called_at_counts() -> None:
    laws = [{"op": Fraction(1, 2), "at": Fraction(1, number)} for number in (2, 3)]
    assert len({*map(digest_of, laws)}) == len(laws)
    written = [Operation("not", (0,), "bool", at=(line, 1)) for line in (1, 2)]
    assert len({*map(digest_of, written)}) == 1


def test_what_has_no_text_is_refused() -> None:
    with pytest.raises(TypeError, match="of the type object"):
        digest_of(object())
