"""Whether a package is what it would be rendered to: then nothing needs to be rendered."""

from __future__ import annotations

from pathlib import Path

from eddi_scaffold.packages import transaction
from eddi_scaffold.packages.rendering import Template, read_answers
from eddi_scaffold.packages.unpacking import Unpacked
from eddi_scaffold.platforms import PackageAnswers
from eddi_scaffold.regions.bases import read_bases
from eddi_scaffold.regions.check import broken_files, unfit_files
from eddi_scaffold.regions.generated import is_placed
from eddi_scaffold.regions.manifest import recorded_rendering, rendering_digest
from eddi_scaffold.regions.store import PRISTINE

UNCOMMITTED = ".eddi/uncommitted"
"""Says that the templates were not exactly those of the commit in the answers."""


def is_current(target: Path, package: PackageAnswers, template: Template, source: Unpacked) -> bool:
    """Return whether a rendering would change nothing, by what the package itself records.

    Args:
        target: folder of the package.
        package: what it should be.
        template: what the answers file should record as the origin.
        source: the templates that would be used.
    """
    if source.changed or package.saved or target.is_symlink() or not target.is_dir():
        return False
    origin = {"_commit": source.commit, "_src_path": template.location}
    answers = read_answers(target) or {}
    wanted = {**package.answers, **origin}
    if any(answers.get(key, _NOTHING) != value for key, value in wanted.items()):
        return False
    tree = transaction.survey(target)
    if tree.others or UNCOMMITTED in tree.files or broken_files(target) or unfit_files(target):
        return False
    if any(tree.files.get(name, _NO_FILE).data != data for name, data in package.files.items()):
        return False
    return recorded_rendering(target) == rendering_digest(target) and _is_whole(target, tree)


_NOTHING = object()
_NO_FILE = transaction.FileState(b"\0")


def _is_whole(target: Path, tree: transaction.FolderContent) -> bool:
    """Return whether all that the last rendering made is there, merged, and as it was made."""
    if not is_placed(target):
        return False
    return (
        read_bases(target).keys() <= tree.files.keys()
        and not any(name.startswith((f"{PRISTINE}/", ".eddi/orphans/")) for name in tree.files)
        and all(one.executable for one in tree.files.values() if one.data.startswith(b"#!"))
    )
