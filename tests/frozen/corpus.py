"""What is frozen: folders of models and configurations, from the repository or made at random."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import yaml

from tests.data_files import ORACLES
from tests.frozen.random_models import MAKERS

EXAMPLES = Path(__file__).parents[2] / "examples"
MODELS = {".xml", ".events", ".bif", ".dne", ".xdsl", ".yml"}
"""Suffixes of files that may be a model."""
NO_MODELS = re.compile(r"README.*|package\.xml|.*deployment\.yml|drone|.*\.part\.xml")
ROBOTS = {
    "examples/robot-models": ("--system", "rover.rossystem", "--models", "nodes"),
}
"""Folder -> options that name the models of its robot."""
RUNS: Mapping[str, Sequence[str]] = yaml.safe_load(
    Path(__file__).with_name("runs.yml").read_text("utf-8")
)
"""Folder -> words after ``run``."""


def folders() -> list[str]:
    """Return the names of what is in the repository."""
    examples = (f"examples/{one.name}" for one in EXAMPLES.iterdir() if one.is_dir())
    oracles = (f"oracles/{one.name}" for one in ORACLES.iterdir() if one.is_dir())
    return sorted([*examples, *oracles])


def cases(name: str) -> Iterator[tuple[str, Mapping[str, bytes]]]:
    """Yield the folders below one of the names: name, and its files by name."""
    top, _, rest = name.partition("/")
    place = {"examples": EXAMPLES, "oracles": ORACLES}[top] / rest
    for folder in sorted({path.parent for path in place.rglob("*") if path.is_file()}):
        parts = folder.relative_to(place).parts
        if parts[:1] in (("expected",), ("rover",), ("nodes",)):
            continue
        files = {
            str(path.relative_to(folder)): path.read_bytes()
            for path in folder.rglob("*")
            if path.is_file() and "expected" not in path.relative_to(folder).parts
        }
        own = {path: data for path, data in files.items() if "/" not in path or top == "examples"}
        yield "/".join([name, *parts]), own
    for path in sorted(place.rglob("*.yml") if top == "oracles" else ()):
        for case, texts in _inside(path):
            files = {one: text.encode() for one, text in texts.items()}
            yield f"{name}/{path.stem}/{case}".rstrip("/"), files


def _inside(path: Path) -> Iterator[tuple[str, Mapping[str, str]]]:
    """Yield the folders that an oracle writes down within one file."""
    content = _content(path)
    if not isinstance(content, dict):
        return
    if isinstance(content.get("files"), dict):
        yield "", content["files"]
    for case in content.get("cases", ()):
        if isinstance(case, dict) and isinstance(case.get("files"), dict):
            yield str(case["id"]), case["files"]
    if path.parent.name == "conserts":
        for name, model in content["models"].items():
            yield name, {f"{name}.yml": yaml.safe_dump(model, sort_keys=False)}


@cache
def _content(path: Path) -> Any:
    try:
        return yaml.load(path.read_text("utf-8"), yaml.CSafeLoader)
    except (yaml.YAMLError, UnicodeDecodeError):
        return None


def configurations(folder: Path) -> list[str]:
    """Return the names of the configurations in a folder."""
    texts = {path.name: path.read_bytes() for path in sorted(folder.glob("*.yml"))}
    return [name for name, text in texts.items() if re.search(rb"^Model:", text, re.MULTILINE)]


def models(folder: Path) -> list[str]:
    """Return the names of the files in a folder that may be models."""
    names = sorted(path.name for path in folder.iterdir() if path.suffix in MODELS)
    others = {*configurations(folder), *(name for name in names if NO_MODELS.fullmatch(name))}
    return [name for name in names if name not in others and not _is_oracle(folder / name)]


def _is_oracle(path: Path) -> bool:
    """Tell whether a file holds what is to be computed, not a model."""
    content = _content(path) if path.suffix == ".yml" else None
    return isinstance(content, dict) and bool(
        {"cases", "pairs", "files", "posteriors", "statistics", "truth_tables", "counts"}
        & content.keys()
    )


def random_cases(kind: str, count: int) -> Iterator[tuple[str, Mapping[str, bytes]]]:
    """Yield the first so many random folders of a kind."""
    for number in range(count):
        files = {name: text.encode() for name, text in MAKERS[kind](number).items()}
        yield f"random/{kind}/{number:03}", files
