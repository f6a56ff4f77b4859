"""Packages of earlier versions come over, edits in place: how they ran, and where records were."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.checkouts import HERE, git

BEFORE = "9439789"
"""The last version that compiled models on the robot."""
BASES_APART = "aebcb0e"
"""The last version that kept each base as a file of its own."""
pytestmark = pytest.mark.slow


class Templates:
    """A clone of this repository with two versions."""

    def __init__(self, path: Path, before: str) -> None:
        self.path = path
        known = ["git", "-C", str(HERE), "cat-file", "-e", f"{before}^{{commit}}"]
        if subprocess.run(known, capture_output=True, check=False).returncode:
            pytest.skip("the history of this checkout does not reach back so far")
        command = ["git", "clone", "--quiet", "--shared", str(HERE), str(path)]
        subprocess.run(command, check=True, capture_output=True)
        git(path, "tag", "v0.1.0", before)
        git(path, "tag", "v0.2.0", "HEAD")

    def eddi(self, version: str, *words: object, cwd: Path) -> str:
        """Run the command line of a version; return what it printed."""
        git(self.path, "checkout", "--quiet", version)
        environment = {**os.environ, "PYTHONPATH": f"{self.path}:{self.path}/runtime_lib/src"}
        command = [sys.executable, "-m", "eddi_scaffold", *map(str, words)]
        done = subprocess.run(
            command, cwd=cwd, env=environment, capture_output=True, text=True, check=False
        )
        return f"{done.returncode} {done.stdout}{done.stderr}"


def test_they_come_over(tmp_path: Path) -> None:
    templates = Templates(tmp_path / "templates", BEFORE)
    examples = templates.path / "examples"
    conserts, events = examples / "two-conserts", examples / "motor-watch"
    first = ("-m", conserts / "two_conserts.xml", "-c", conserts / "consert_a_config.yml")
    second = ("-m", events / "motor_watch.events", "-c", events / "motor_config.yml")
    third = ("-m", conserts / "two_conserts.xml", "-c", conserts / "consert_b_config.yml")
    workspace = tmp_path / "ws"
    (workspace / "src").mkdir(parents=True)
    for files in (first, second):
        done = templates.eddi("v0.1.0", "generate", "-w", workspace, *files, cwd=tmp_path)
        assert done.startswith("0 "), done
    packages = workspace / "src" / "eddi_monitor"
    code = packages / "conserta" / "src" / "conserta" / "EDDIInput.py"
    code.write_text(code.read_text().replace("= RtE_E0.data\n", "= RtE_E0.data and True\n"))
    manifest = packages / "eddi_runtime" / "package.xml"
    manifest.write_text(manifest.read_text().replace("</package>", "  <!-- ours -->\n</package>"))
    monitor = packages / "conserta" / "src" / "conserta" / "EDDIMonitor.py"
    edited = monitor.read_text() + "\nMINE = 1\n"
    monitor.write_text(edited)
    git(workspace, "init", "--quiet")
    git(workspace, "add", "--all")
    git(workspace, "commit", "--quiet", "--message", "old")

    refused = templates.eddi("v0.2.0", "generate", "-w", workspace, *third, cwd=tmp_path)
    assert refused.startswith("2 "), refused
    assert "[G024]" in refused

    copier = [str(Path(sys.executable).with_name("copier")), "update", "--trust", "--defaults"]
    where = packages / "conserta"
    subprocess.run(
        [*copier, "--vcs-ref", "v0.2.0", "."], cwd=where, check=True, capture_output=True
    )
    compiled = where / "src" / "conserta" / "compiled.py"
    assert "class Monitor(consert.ConSert):" in compiled.read_text("utf-8")
    assert code.read_text().count("RtE_E0.data and True") == 1
    kept = where / ".eddi" / "rejects" / "src" / "conserta" / "EDDIMonitor.py.edited"
    assert kept.read_text() == edited
    kept.unlink()
    assert "MINE" not in monitor.read_text()
    git(workspace, "add", "--all")
    git(workspace, "commit", "--quiet", "--message", "conserta")

    done = templates.eddi("v0.2.0", "upgrade", "-w", workspace, cwd=tmp_path)
    assert done.startswith("0 "), done
    assert code.read_text().count("RtE_E0.data and True") == 1
    assert manifest.read_text().count("<!-- ours -->") == 1
    assert (packages / "motor_watch" / "src" / "motor_watch" / "compiled.py").is_file()
    assert not list(packages.rglob("*.rej"))
    done = templates.eddi("v0.2.0", "status", "-w", workspace, cwd=tmp_path)
    assert done.startswith("0 "), done
    done = templates.eddi("v0.2.0", "generate", "-w", workspace, *third, cwd=tmp_path)
    assert done.startswith("0 "), done


def test_records_come_over(tmp_path: Path) -> None:
    templates = Templates(tmp_path / "templates", BASES_APART)
    conserts = templates.path / "examples" / "two-conserts"
    model, workspace = ("-m", conserts / "two_conserts.xml"), tmp_path / "ws"
    (workspace / "src").mkdir(parents=True)
    for letter in "ab":
        config = conserts / f"consert_{letter}_config.yml"
        files = (*model, "-c", config)
        done = templates.eddi("v0.1.0", "generate", "-w", workspace, *files, cwd=tmp_path)
        assert done.startswith("0 "), done
    packages = workspace / "src" / "eddi_monitor"
    edits = {
        "conserta/src/conserta/EDDIInput.py": ("= RtE_E0.data\n", "= RtE_E0.data and True\n"),
        "consertb/src/consertb/EDDIInput.py": (
            "import EDDIInputBase\n",
            "import EDDIInputBase  # ours\n",
        ),
        "conserta/package.xml": ("</package>", "  <!-- ours -->\n</package>"),
        "eddi_runtime/package.xml": ("</package>", "  <!-- ours -->\n</package>"),
    }
    for name, edit in edits.items():
        text = (packages / name).read_text()
        assert edit[0] in text
        (packages / name).write_text(text.replace(*edit))
    git(workspace, "init", "--quiet")
    git(workspace, "add", "--all")
    git(workspace, "commit", "--quiet", "--message", "old")

    copier = [str(Path(sys.executable).with_name("copier")), "update", "--trust", "--defaults"]
    where = packages / "conserta"
    subprocess.run(
        [*copier, "--vcs-ref", "v0.2.0", "."], cwd=where, check=True, capture_output=True
    )
    git(workspace, "add", "--all")
    git(workspace, "commit", "--quiet", "--message", "conserta")
    records = {path.name for path in (where / ".eddi").rglob("*")}
    assert records == {"bases", "manifest.json"}
    done = templates.eddi("v0.2.0", "regions", "--check", where, cwd=tmp_path)
    assert done.startswith("0 "), done

    done = templates.eddi("v0.2.0", "upgrade", "-w", workspace, cwd=tmp_path)
    assert done.startswith("0 "), done
    for name, (_, own) in edits.items():
        assert (packages / name).read_text().count(own) == 1
    for package in packages.iterdir():
        assert {path.name for path in (package / ".eddi").rglob("*")} == records, package
    done = templates.eddi("v0.2.0", "status", "-w", workspace, cwd=tmp_path)
    assert done.startswith("0 "), done
