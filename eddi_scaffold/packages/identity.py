"""Which model a package is of: a name alone does not tell where models are renamed.

A model that is renamed leaves its old package behind; models, or inputs, that swap their names get
each other's hand-written code. What can be seen of it is reported; what moves, a person declares.
"""

from __future__ import annotations

import json
from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.loading import read_models
from eddi_scaffold.packages.answers_check import model_id
from eddi_scaffold.packages.handwritten import region_of, written
from eddi_scaffold.platforms import PackageAnswers

_PLACES = frozenset({"line", "path", "source", "sha256"})
"""Keys of a model's record that tell where it was read, not what it is."""
Present = Mapping[str, Mapping[str, Any]]


def left_behind(
    present: Present,
    packages: Sequence[PackageAnswers],
    monitors: Sequence[BoundMonitor],
    gone: Collection[str],
) -> Iterator[tuple[str, bool]]:
    """Report packages that a renamed model seems to have left behind.

    Args:
        present: package -> answers of those that were there before the command.
        packages: what the command makes.
        monitors: the monitors among them.
        gone: packages that it renames.

    Yields:
        A sentence, and whether it is news: a package was made that was not there.
    """
    made = [package for package in packages if "model_json" in package.answers]
    folders = {*gone, *(package.folder for package in made)}
    known: set[tuple[str, str]] = set()
    for folder, answers in present.items():
        heirs = [] if folder in folders else [one for one in made if _may_be(one.answers, answers)]
        if not heirs:
            continue
        if not known:
            sources = {monitor.model.source.name: monitor.model.source for monitor in monitors}
            models = (model for one in sources.values() for model in read_models(one).models)
            known = {(model.kind, model.name) for model in models}
        if (answers["kind"], model_id(answers)) not in known:
            new = [one for one in heirs if one.folder not in present]
            heir = (new or heirs)[0]
            old, now = model_id(answers), model_id(heir.answers)
            text = (
                f"{folder} was made of {old!r}, a model that is no longer there, and its monitor "
                f"still runs; if the name is {now!r} now, repeat this with `--rename "
                f"{folder}={heir.folder}`, which takes hand-written code along, else remove the "
                "folder and repeat this"
            )
            yield text, bool(new)


def exchanged(
    root: Path, present: Present, packages: Sequence[PackageAnswers], moved: Collection[str] = ()
) -> Iterator[str]:
    """Report hand-written code that belongs to another model, or another input, by all appearances.

    Args:
        root: folder of all packages.
        present: package -> answers of those that were there before the command.
        packages: what it makes.
        moved: packages whose code moves by a declared rename.
    """
    before = {folder: _content(answers) for folder, answers in present.items()}
    for package in packages:
        folder, old = package.folder, present.get(package.folder)
        if folder in moved or old is None or "model_json" not in old:
            continue
        now = _content(package.answers)
        owner = next((name for name, one in before.items() if one == now), folder)
        if owner != folder and before[folder] != now and written(root / folder):
            yield (
                f"{folder} keeps its hand-written code, but its model is now what that of {owner} "
                f"was; if models changed names, repeat this as `generate` with `--rename "
                f"{owner}={folder}` and the others at once"
            )
        yield from _exchanged_inputs(root / folder, old, package.answers)


def _exchanged_inputs(
    package: Path, old: Mapping[str, Any], new: Mapping[str, Any]
) -> Iterator[str]:
    before, after = _topics(old), _topics(new)
    begins = {item["id"]: item["region_begin"] for item in old["inputs"]}
    for item in new["inputs"]:
        name = item["id"]
        owner = next((one for one, of in before.items() if of == after[name]), name)
        same = begins.get(name) == item["region_begin"]  # else a rename or the signature tells
        moved = name in before and owner != name and same and before[name] != after[name]
        if moved and region_of(item) in written(package):
            yield (
                f"{package.name}: {item['title']} keeps its hand-written code, but reads "
                f"{after[name]} now, as another input did before; if inputs changed names, "
                "declare `renamed_from`"
            )


def _topics(answers: Mapping[str, Any]) -> dict[str, str]:
    return {item["id"]: item["sources"] for item in answers["inputs"]}


def _may_be(new: Mapping[str, Any], old: Mapping[str, Any]) -> bool:
    """Return whether two packages may be of one model: by its file, or by what it reads."""
    if "model_json" not in old or new["kind"] != old["kind"]:
        return False
    topics = _topics(new)
    return new["model_file"] == old["model_file"] or (bool(topics) and topics == _topics(old))


def _content(answers: Mapping[str, Any]) -> object:
    """Return what a package's model is, without its name and its places; ``None`` without one."""
    if "model_json" not in answers:
        return None
    record = json.loads(answers["model_json"])
    return _without_places({key: value for key, value in record.items() if key != "id"})


def _without_places(value: object) -> object:
    if isinstance(value, dict):
        return {key: _without_places(one) for key, one in value.items() if key not in _PLACES}
    return [_without_places(one) for one in value] if isinstance(value, list) else value
