"""Render one package with Copier: the only importer of copier.

The template is this project's own repository: the checkout that runs, or, for an installed wheel,
the git bundle that travels in it and is put where a later ``copier update`` finds it again.
"""

from __future__ import annotations

import os
import re
import tempfile
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from types import CodeType
from typing import TYPE_CHECKING, Any

from eddi_scaffold import __version__
from eddi_scaffold.common.files import read_source
from eddi_scaffold.common.problems import EddiError, problem
from eddi_scaffold.packages.unpacking import Unpacked
from eddi_scaffold.regions.marked_file import sides_of
from eddi_scaffold.yaml_text.nodes import read_document, value_11
from eddi_scaffold.yaml_text.writer import dump_11

if TYPE_CHECKING:
    from copier._main import Worker

ANSWERS_FILE = ".copier-answers.yml"
_BUNDLE = "templates.bundle"
_BUNDLE_VERSION = "templates.version"
_ORIGIN = re.compile(r"^_src_path:.*\n(?:[ ].*\n|\n)*", re.MULTILINE)
"""Origin in an answers file that is rendered from a plain folder; long paths are folded."""


@dataclass(frozen=True)
class Template:
    """Where Copier finds the templates."""

    location: str  # path as it is recorded in the answers file (`_src_path`)
    ref: str | None  # git reference to render
    bundle: Path | None = None  # of an installed wheel, what `keep` puts at the location

    def keep(self) -> None:
        """Put the wheel's bundle where packages refer to their templates (EddiError, T001)."""
        if self.bundle is None:
            return
        target = Path(self.location).expanduser()
        version = target.with_name(_BUNDLE_VERSION)
        try:
            shelved = version.read_text("utf-8", "replace") if version.is_file() else ""
            if not is_newer(shelved):  # a newer bundle holds this version as well
                target.parent.mkdir(parents=True, exist_ok=True)
                _replace(target, self.bundle.read_bytes())
                _replace(version, __version__.encode())
        except OSError as failure:
            raise EddiError(
                problem("T001.not_written", target=target, reason=failure.strerror)
            ) from None


def own_template() -> Template:
    """Return the templates that belong to the running eddi-scaffold (T001 where they are not)."""
    package = Path(__file__).resolve().parents[1]
    root = package.parent
    in_sources = (root / "copier.yml").is_file()
    if in_sources and (root / ".git").exists():
        return Template(str(root), "HEAD")
    for bundle in (package / _BUNDLE, root / _BUNDLE):  # installed; an unpacked sdist
        if bundle.is_file():
            # below the home folder: the same for every user
            home = Path("~").expanduser()
            data = Path(os.environ.get("XDG_DATA_HOME") or home / ".local" / "share")
            target = data / "eddi-scaffold" / _BUNDLE
            inside = target.is_relative_to(home)
            location = f"~/{target.relative_to(home)}" if inside else str(target)
            return Template(location, f"v{__version__}", bundle)
    if in_sources:
        return Template(str(root), None)
    raise EddiError(problem("T001.missing"))


def is_newer(version: str) -> bool:
    """Return whether a version is of a later release than this one; no version is none."""
    try:
        return release(version) > release(__version__)
    except ValueError:
        return False


def release(version: str) -> tuple[int, ...]:
    """Return the numbers of a version; of another text, ValueError."""
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
    source = read_source(path)
    node, problems = read_document(source, "T005")
    if node is None:
        hint = "put it back: git checkout -- FILE, or copy the package again with plain copier copy"
        if len(sides_of(source.data.decode(errors="replace"))) > 1:
            hint = f"take one side and generate again: git checkout --ours {path}"
        raise EddiError(*(replace(problem, hint=hint) for problem in problems))
    data = value_11(node)
    known = isinstance(data, dict) and "template" in data and "generator_version" in data
    return data if known else None


class Renderer:
    """Copier for the packages of one command: what it finds out for the first one serves all.

    The templates lie in a plain folder and each package is rendered into a scratch folder, so
    Copier is not shown git: it would ask it several things of both, one for each file.
    """

    def __init__(self, template: Template, source: Unpacked) -> None:
        """Prepare to render templates that were taken out of git; files record where they are."""
        self.template, self.source = template, source
        self._first: Worker | None = None

    def render(self, answers: Mapping[str, Any], folder: Path) -> None:
        """Render a package into an empty or missing folder (EddiError, T004)."""
        # half a second, paid only where something is rendered
        from copier.errors import CopierError  # noqa: PLC0415
        from plumbum import local  # noqa: PLC0415

        with warnings.catch_warnings(), local.env(PATH=os.devnull):
            warnings.simplefilter("ignore")
            try:
                self._run(dict(answers), folder)
            except (CopierError, ValueError) as failure:
                raise EddiError(problem("T004.copier", reason=failure)) from failure
        # what Copier would have recorded, had it cloned the templates itself
        commit, file = self.source.commit, folder / ANSWERS_FILE
        known = {} if commit is None else {"_commit": commit}
        origin = dump_11({**known, "_src_path": self.template.location})
        file.write_text(_ORIGIN.sub(lambda _: origin, file.read_text("utf-8"), count=1), "utf-8")

    def _run(self, answers: dict[str, Any], folder: Path) -> None:
        words = ("defaults", "overwrite", "unsafe", "quiet", "skip_tasks")
        settings: dict[str, Any] = dict.fromkeys(words, True)
        if self._first is None:
            from copier._main import Worker  # noqa: PLC0415

            self._first = Worker(str(self.source.folder), **settings)
            self._first.jinja_env.auto_reload = False
            _compile_once(self._first.jinja_env)
        worker = replace(self._first, dst_path=folder, data=answers)
        worker.template, worker.jinja_env = self._first.template, self._first.jinja_env
        worker.run_copy()


def _compile_once(environment: Any) -> None:
    """Let Jinja remember what it compiled: each package has the same questions and paths."""
    compile_anew: Callable[..., CodeType] = environment.compile
    compiled: dict[object, CodeType] = {}

    def compile_(source: object, *details: str | None, **more: bool) -> CodeType:
        # of a tree there is no second one; what reads a `yield` keeps its state in the environment
        if not isinstance(source, str) or "yield" in source:
            return compile_anew(source, *details, **more)
        key = (source, details, *more.items())
        if key not in compiled:
            compiled[key] = compile_anew(source, *details, **more)
        environment.preprocess(source)  # in which Copier forgets the `yield` of another text
        return compiled[key]

    environment.compile = compile_
