"""A model that is renamed leaves its old package behind: that is reported, a person declares it."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any

from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.loading import read_models
from eddi_scaffold.packages.workspace import model_id
from eddi_scaffold.platforms import PackageAnswers

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
    made = [package for package in packages if "facts_json" in package.answers]
    folders = {*gone, *(package.folder for package in made)}
    known: set[tuple[str, str]] = set()
    for folder, answers in present.items():
        heirs = [] if folder in folders else [one for one in made if _may_be(one.answers, answers)]
        if not heirs:
            continue
        if not known:
            sources = {monitor.model.source.name: monitor.model.source for monitor in monitors}
            models = (model for source in sources.values() for model in read_models(source).models)
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


def _topics(answers: Mapping[str, Any]) -> dict[str, str]:
    return {item["id"]: item["sources"] for item in answers["inputs"]}


def _may_be(new: Mapping[str, Any], old: Mapping[str, Any]) -> bool:
    """Return whether two packages may be of one model: by its file, or by what it reads."""
    if "facts_json" not in old or new["kind"] != old["kind"]:
        return False
    topics = _topics(new)
    return new["model_file"] == old["model_file"] or (bool(topics) and topics == _topics(old))
