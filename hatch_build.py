"""Put the templates into the wheel: a git bundle with every released version.

Copier stores no version for a plain folder, and then never updates; a bundle is a git repository in
one file. It holds the paths that rendering needs, one commit and one tag for each release.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

PATHS = (
    "copier.yml",
    "copier_templates",
    "eddi_scaffold/__init__.py",
    "eddi_scaffold/regions",
    "runtime_lib/src",
)
BUNDLE = "templates.bundle"


class TemplateBundle(BuildHookInterface):  # type: ignore[type-arg]
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
            if (root / "copier_templates/plain_monitor/eddi_runtime").is_symlink():
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
    git = _Git(scratch / "templates.git")
    git("init", "--quiet", "--bare", "--initial-branch=main", ".")
    current = f"v{version}"
    for tag in _releases(root):
        if tag != current:
            _commit_release(root, scratch / tag, tag, git)
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
    _commit(work, current, git)
    bundle = scratch / BUNDLE
    git("-c", "pack.threads=1", "bundle", "create", "--quiet", str(bundle), "--all", "HEAD")
    return bundle


class _Git:
    """Git on one bare repository, the same for everybody: no user configuration, fixed dates."""

    def __init__(self, repository: Path) -> None:
        repository.mkdir(parents=True)
        self.repository = repository

    def __call__(self, *arguments: str, work: Path | None = None) -> str:
        who = {
            "NAME": "eddi-scaffold",
            "EMAIL": "release@eddi-scaffold.invalid",
            "DATE": "@946684800 +0000",
        }
        environment = {
            **os.environ,
            "GIT_CONFIG_GLOBAL": os.devnull,
            "GIT_CONFIG_NOSYSTEM": "1",
            **{
                f"GIT_{role}_{key}": value
                for role in ("AUTHOR", "COMMITTER")
                for key, value in who.items()
            },
        }
        if work is not None:
            environment |= {"GIT_DIR": str(self.repository), "GIT_WORK_TREE": str(work)}
        return _run(["git", *arguments], work or self.repository, environment)


def _releases(root: Path) -> list[str]:
    if not (root / ".git").exists():
        return []
    tags = _run(["git", "tag", "--list", "v*", "--sort=version:refname"], root, None).split()
    return [tag for tag in tags if re.fullmatch(r"v\d+\.\d+\.\d+", tag)]


def _commit_release(root: Path, work: Path, tag: str, git: _Git) -> None:
    work.mkdir()
    present = _run(["git", "ls-tree", "--name-only", tag, "--", *PATHS], root, None).split()
    archive = work.with_suffix(".tar")
    _run(["git", "archive", "--format=tar", f"--output={archive}", tag, "--", *present], root, None)
    shutil.unpack_archive(archive, work)
    _commit(work, tag, git)


def _commit(work: Path, tag: str, git: _Git) -> None:
    git("add", "--all", "--force", ".", work=work)
    git(
        "commit",
        "--quiet",
        "--allow-empty",
        "--no-gpg-sign",
        "--message",
        f"Templates of {tag}",
        work=work,
    )
    git("tag", tag, work=work)


def _run(command: list[str], folder: Path, environment: dict[str, str] | None) -> str:
    return subprocess.run(
        command, cwd=folder, env=environment, check=True, capture_output=True, text=True
    ).stdout
