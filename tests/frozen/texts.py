"""The texts that must stay: what a command writes, without what is meant to change."""

from __future__ import annotations

import ast
import hashlib
import json
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import yaml

from tests.cli.command import run

Parts = Mapping[str, str]
"""Part of a text -> its lines; each part has a digest of its own."""

REFUSED = 2
"""Exit status of a command that cannot use its files."""

_LAST_OF_HEAD = "# sha256 of the lines below: "
_DIGEST = re.compile(r'(?m)^(    digest = )"[0-9a-f]{64}"$')
_COMPUTED: dict[str, str] = {}
"""Digest of a model -> that of what it computes, of all that were compiled here."""
_MEANT_TO_CHANGE = {"model_sha256", "generator_version"}


def compiled_text(answers: Mapping[str, Any]) -> str:
    """Return the ``compiled.py`` of a package from the answers that it is rendered with.

    This is the only function that may follow the product when it compiles in another place:
    ``test_texts_are_those_of_packages`` compares what it returns with the examples' packages.
    """
    file = Path(answers["files_folder"], "compiled.py")
    return file.read_text("utf-8").removeprefix("# fmt: off\n")


def compiled(folder: Path, *words: object) -> Parts:
    """Return head and body of a compiled monitor; nothing where ``answers`` refuses the files."""
    file = folder / "answers.yml"
    result = run("answers", *words, "-o", file.name, cwd=folder)
    if result.status == REFUSED:
        return {}
    assert file.exists(), result
    answers = yaml.load(file.read_text("utf-8"), yaml.CSafeLoader)
    parts = parts_of(compiled_text(answers))
    digest, computed = json.loads(answers["facts"])["model"]["digest"], computed_by(parts["body"])
    assert _COMPUTED.setdefault(digest, computed) == computed, "two models have one digest"
    return parts


def computed_by(body: str) -> str:
    """Return a digest of what a text computes: comments and the form of its lines do not count.

    Nor does what it knows only for the sentences that say why: topics, claims of others, places.
    """
    tree = ast.parse(body)
    for node in ast.walk(tree):
        if isinstance(node, ast.ClassDef):
            node.body = [one for one in node.body if not ast.unparse(one).startswith("topics = ")]
        elif isinstance(node, ast.Call):
            node.keywords = [one for one in node.keywords if one.arg not in ("claims", "place")]
    return hashlib.sha256(ast.dump(tree).encode()).hexdigest()


def parts_of(text: str) -> Parts:
    """Return head and body of ``compiled.py`` without the digests of the model and of the body."""
    head, _, body = text.partition(_LAST_OF_HEAD)
    return {"head": head, "body": _DIGEST.sub(r"\1DIGEST", body.partition("\n")[2])}


def names_of_models(folder: Path, file: str) -> Iterator[str]:
    """Yield the names of the models in a file."""
    out = run("show", file, "--json", cwd=folder).out
    for model in json.loads(out).get("models", ()) if out.startswith("{") else ():
        yield model["name"]


def printed(folder: Path, *words: object) -> Parts:
    """Return what a command prints as JSON.

    The place of the folder is left out, and the digests of models, which are over how the product
    represents them. Of problems, levels and places are a part of their own: words and codes may
    change where these do not.
    """
    result = run(*words, "--json", cwd=folder)
    text = result.out.replace(str(folder), "FOLDER")
    contents = [_stable(json.loads(line)) for line in _documents(text)]
    whole = json.dumps([result.status, *contents], indent=1, ensure_ascii=False)
    places = [
        [one["level"], *(one.get(key) for key in ("file", "line", "col"))]
        for content in contents
        if isinstance(content, dict)
        for one in content.get("problems", ())
    ]
    if words[0] != "check":
        return {"text": whole}
    return {"text": whole, "places": json.dumps([result.status, *sorted(places, key=str)])}


def _documents(text: str) -> list[str]:
    """Return the documents of an output: one, or one a line."""
    try:
        json.loads(text)
    except ValueError:
        return text.splitlines()
    return [text]


def _stable(content: Any) -> Any:
    if isinstance(content, list):
        kept = (one for one in content if not _is_of_the_runtime(one))
        return [_stable(one) for one in kept]
    if isinstance(content, dict):
        return {key: _stable(it) for key, it in content.items() if key not in _MEANT_TO_CHANGE}
    return content


def _is_of_the_runtime(name: object) -> bool:
    """Tell whether something is a file of the runtime library, which expected packages lack."""
    return isinstance(name, str) and re.match(r"(src/)?eddi_runtime/", name) is not None
