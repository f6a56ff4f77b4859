"""Render one package with Copier: the only importer of copier.

The template is this project's own repository: the checkout that runs, or, for an installed wheel,
the git bundle that travels in it and is put where a later ``copier update`` finds it again.
"""

from __future__ import annotations

import os
import re
import tempfile
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from eddi_scaffold import __version__
from eddi_scaffold.packages.unpacking import Unpacked
from eddi_scaffold.positioned_yaml.nodes import dump_11, read_document, value_11
from eddi_scaffold.problems import EddiError, error
from eddi_scaffold.source import read_source

ANSWERS_FILE = ".copier-answers.yml"
_BUNDLE = "templates.bundle"
_BUNDLE_VERSION = "templates.version"


@dataclass(frozen=True)
class Template:
    """Where Copier finds the templates.

    Attributes:
        location: path as it is recorded in the answers file (``_src_path``).
        ref: git reference to render.
        bundle: of an installed wheel, the file that :meth:`keep` puts at the location.
    """

    location: str
    ref: str | None
    bundle: Path | None = None

    def keep(self) -> None:
        """Put the wheel's bundle where a package refers to its templates.

        Raises:
            EddiError: it cannot be put there (T002).
        """
        if self.bundle is None:
            return
        target = Path(self.location).expanduser()
        version = target.with_name(_BUNDLE_VERSION)
        try:
            if not _is_newer(version):  # a newer bundle holds this version as well
                target.parent.mkdir(parents=True, exist_ok=True)
                _replace(target, self.bundle.read_bytes())
                _replace(version, __version__.encode())
        except OSError as problem:
            message = f"cannot put the templates at {target}: {problem.strerror}"
            hint = "set XDG_DATA_HOME to a folder you can write"
            raise EddiError(error("T002", message, hint=hint)) from None


def own_template() -> Template:
    """Return the templates that belong to the running eddi-scaffold.

    Raises:
        EddiError: neither a checkout nor a bundle is there (T001).
    """
    package = Path(__file__).resolve().parents[1]
    root = package.parent
    in_sources = (root / "copier.yml").is_file()
    if in_sources and (root / ".git").exists():
        return Template(str(root), "HEAD")
    for bundle in (package / _BUNDLE, root / _BUNDLE):  # installed; an unpacked sdist
        if bundle.is_file():
            return Template(_shelved(), f"v{__version__}", bundle)
    if in_sources:
        return Template(str(root), None)
    hint = "install eddi-scaffold again, or run it from a git checkout"
    raise EddiError(error("T001", "the templates of eddi-scaffold are missing", hint=hint))


def _shelved() -> str:
    """Return where the wheel's bundle is kept: below the home folder, the same for every user."""
    home = Path("~").expanduser()
    data = Path(os.environ.get("XDG_DATA_HOME") or home / ".local" / "share")
    target = data / "eddi-scaffold" / _BUNDLE
    return f"~/{target.relative_to(home)}" if target.is_relative_to(home) else str(target)


def _is_newer(version_file: Path) -> bool:
    """Return whether the bundle on the shelf came with a later release than this one."""
    try:
        return _release(version_file.read_text("utf-8")) > _release(__version__)
    except (OSError, ValueError):
        return False


def _release(version: str) -> tuple[int, ...]:
    return tuple(int(part) for part in version.strip().split("."))


def _replace(target: Path, data: bytes) -> None:
    if target.is_file() and target.read_bytes() == data:
        return
    with tempfile.NamedTemporaryFile(dir=target.parent, delete=False) as file:
        file.write(data)
    Path(file.name).replace(target)


def read_answers(package: Path) -> dict[str, Any] | None:
    """Read what a package was generated from; ``None`` when it is not a package of ours.

    Raises:
        EddiError: its answers cannot be read, for instance after a conflict in git (T005).
    """
    path = package / ANSWERS_FILE
    if not path.is_file():
        return None
    node, problems = read_document(read_source(path), "T005")
    if node is None:
        hint = "put it back: git checkout -- FILE, or copy the package again with plain copier copy"
        raise EddiError(*(replace(problem, hint=hint) for problem in problems))
    data = value_11(node)
    known = isinstance(data, dict) and "template" in data and "generator_version" in data
    return data if known else None


def render(
    answers: Mapping[str, Any], template: Template, source: Unpacked, folder: Path
) -> list[str]:
    """Render a package into an empty or missing folder.

    Args:
        answers: all answers of the package's template.
        template: what the answers file records as the origin.
        source: the same templates, taken out of git.
        folder: where to.

    Returns:
        Copier's warnings.

    Raises:
        EddiError: Copier refused (T004).
    """
    import copier  # noqa: PLC0415 - half a second, paid only where something is rendered
    from copier.errors import CopierError  # noqa: PLC0415 - the same

    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            copier.run_copy(
                str(source.folder),
                folder,
                data=dict(answers),
                defaults=True,
                overwrite=True,
                unsafe=True,
                quiet=True,
                skip_tasks=True,
            )
        except (CopierError, ValueError) as problem:
            raise EddiError(error("T004", f"Copier refused: {problem}")) from problem
    _record_origin(folder / ANSWERS_FILE, template, source)
    return sorted(
        {
            str(warning.message)
            for warning in caught
            if warning.category.__module__.startswith("copier")
        }
    )


_ORIGIN = re.compile(r"^_src_path:.*\n(?:[ ].*\n|\n)*", re.MULTILINE)
"""Origin in an answers file that is rendered from a plain folder; long paths are folded."""


def _record_origin(answers_file: Path, template: Template, source: Unpacked) -> None:
    """Write what Copier would have recorded, had it cloned the templates itself."""
    origin = {"_commit": source.commit} if source.commit is not None else {}
    text = dump_11({**origin, "_src_path": template.location})
    rendered = answers_file.read_text("utf-8")
    answers_file.write_text(_ORIGIN.sub(lambda _: text, rendered, count=1), "utf-8")
