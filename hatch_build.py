"""Put the templates into the wheel: a git bundle with every released version.

Copier stores no version for a plain folder, and then never updates; a bundle is a git repository in
one file. It holds the paths that rendering needs, one commit and one tag for each release.
"""

from __future__ import annotations

import os
import re
import shutil
import sys
import tempfile
from pathlib import Path
from typing import Any

from hatchling.builders.config import BuilderConfig
from hatchling.builders.hooks.plugin.interface import BuildHookInterface

sys.path.insert(0, str(Path(__file__).parent))  # nothing of ours is installed while it is built

from eddi_scaffold.regions.git import git

PATHS = (
    "copier.yml",
    "copier_templates",
    "eddi_scaffold/__init__.py",
    "eddi_scaffold/regions",
    "runtime_lib/src",
)
BUNDLE = "templates.bundle"


class TemplateBundle(BuildHookInterface[BuilderConfig]):
    """Build hook of hatchling for wheel and sdist."""

    PLUGIN_NAME = "custom"

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Make the bundle and add it, and the examples, to what is built."""
        if version == "editable":
            return  # a checkout is its own template
        root = Path(self.root)
        ready = root / BUNDLE  # in an unpacked sdist
        self._scratch = tempfile.mkdtemp(prefix="eddi-bundle-")
        bundle = (
            ready
            if ready.is_file()
            else make_bundle(root, Path(self._scratch), self.metadata.version)
        )
        if self.target_name == "sdist":
            build_data["force_include"][str(bundle)] = BUNDLE
            if any(path.is_symlink() for path in (root / "copier_templates").rglob("*")):
                # hatchling follows the link first, and then takes the folder itself as known
                build_data["force_include"][str(root / "runtime_lib")] = "runtime_lib"
        else:
            build_data["force_include"][str(bundle)] = f"eddi_scaffold/{BUNDLE}"
            build_data["force_include"] |= _examples(root / "examples")

    def finalize(self, version: str, build_data: dict[str, Any], artifact_path: str) -> None:
        """Remove the scratch folder."""
        shutil.rmtree(getattr(self, "_scratch", ""), ignore_errors=True)


def _examples(folder: Path) -> dict[str, str]:
    """Return where each file of the examples goes; expected packages are for our own tests."""
    names = sorted(path.relative_to(folder) for path in folder.rglob("*") if path.is_file())
    shown = [name for name in names if name.parts[1] != "expected"]
    return {str(folder / name): f"eddi_scaffold/_examples/{name}" for name in shown}


def make_bundle(root: Path, scratch: Path, version: str) -> Path:
    """Write the bundle: one commit for each release tag, and one for what is built now."""
    bundled = scratch / "templates.git"
    _git(bundled, "init", "--quiet", "--bare", "--initial-branch=main")
    current = f"v{version}"
    for tag in _releases(root):
        if tag != current:
            _commit_release(root, scratch / tag, tag, bundled)
    work = scratch / "now"
    for path in PATHS:
        source, target = root / path, work / path
        target.parent.mkdir(parents=True, exist_ok=True)
        if source.is_dir():
            shutil.copytree(
                source, target, symlinks=True, ignore=shutil.ignore_patterns("__pycache__")
            )
        else:
            shutil.copy(source, target)
    _commit(work, current, bundled)
    bundle = scratch / BUNDLE
    words = ("-c", "pack.threads=1", "bundle", "create", "--quiet", str(bundle), "--all", "HEAD")
    _git(bundled, *words)
    return bundle


def _git(bundled: Path, *words: str, work: Path | None = None) -> None:
    """Run git on the bundled repository, the same for everybody: no configuration, fixed dates."""
    who = {
        "NAME": "eddi-scaffold",
        "EMAIL": "release@eddi-scaffold.invalid",
        "DATE": "@946684800 +0000",
    }
    roles = ("AUTHOR", "COMMITTER")
    environment = {f"GIT_{role}_{key}": value for role in roles for key, value in who.items()}
    environment |= {"GIT_CONFIG_GLOBAL": os.devnull, "GIT_CONFIG_NOSYSTEM": "1"}
    git(*words, repository=bundled, work_tree=work, environment=environment)


def _releases(root: Path) -> list[str]:
    if not (root / ".git").exists():
        return []
    words = ("tag", "--list", "v*", "--sort=version:refname")
    tags = git(*words, repository=root / ".git").decode().split()
    return [tag for tag in tags if re.fullmatch(r"v\d+\.\d+\.\d+", tag)]


def _commit_release(root: Path, work: Path, tag: str, bundled: Path) -> None:
    work.mkdir()
    released = root / ".git"
    words = ("ls-tree", "--name-only", tag, "--", *PATHS)
    present = git(*words, repository=released).decode().split()
    archive = work.with_suffix(".tar")
    archive.write_bytes(git("archive", "--format=tar", tag, "--", *present, repository=released))
    shutil.unpack_archive(archive, work)
    _commit(work, tag, bundled)


def _commit(work: Path, tag: str, bundled: Path) -> None:
    _git(bundled, "add", "--all", "--force", ".", work=work)
    words = ("--quiet", "--allow-empty", "--no-gpg-sign", "--message", f"Templates of {tag}")
    _git(bundled, "commit", *words, work=work)
    _git(bundled, "tag", tag)
