"""Where the runtime library is, and whether one process runs all monitors of a workspace."""

from __future__ import annotations

import shutil
from pathlib import Path

import jinja2
import pytest
import yaml
from eddi_runtime import __version__

from eddi_scaffold.program.runtime_parts import HOST
from tests.cli.command import EXAMPLE, ROOT, generate, run

RUNTIME = "eddi_runtime"
MODEL = EXAMPLE / "two_conserts.xml"
KEY = "<exec_depend>python3-eddi-runtime-pip</exec_depend>"
MINE = "        self.RtE_A_E0 = RtE_E0.data is True\n"
pytestmark = pytest.mark.slow


def plain(place: Path, *words: str) -> Path:
    files = ("-m", MODEL, "--name", "ConSertA", "-o", place, "--platform", "plain")
    done = run("generate", *files, *words, cwd=place)
    assert done.status == 0, done.err
    return place / "conserta"


@pytest.fixture(scope="module")
def generated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A workspace with one monitor and code of a person."""
    folder = tmp_path_factory.mktemp("made")
    (folder / "src").mkdir()
    generate(folder, "a")
    code = folder / "src/eddi_monitor/conserta/src/conserta/EDDIInput.py"
    text = code.read_text("utf-8")
    assert text.count("        self.RtE_A_E0 = RtE_E0.data\n") == 1
    code.write_text(text.replace("        self.RtE_A_E0 = RtE_E0.data\n", MINE), "utf-8")
    return folder


@pytest.fixture
def packages(generated: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(generated, tmp_path / "ws"), "src/eddi_monitor")


def manifests(packages: Path) -> dict[str, str]:
    """Return package -> its manifest."""
    return {path.parent.name: path.read_text("utf-8") for path in packages.glob("*/package.xml")}


def depends(packages: Path) -> dict[str, set[str]]:
    """Return package -> what it says of the runtime."""
    words = (f"<exec_depend>{RUNTIME}</exec_depend>", KEY)
    return {
        name: {word for word in words if word in text}
        for name, text in manifests(packages).items()
        if RUNTIME not in name
    }


def test_all_monitors_of_a_workspace_change_together(packages: Path) -> None:
    place = packages.parents[1]
    done = generate(place, "b", "--runtime", "installed")
    assert "eddi_runtime: removed, nothing needs it any more" in done.err
    assert not (packages / RUNTIME).exists()
    none = {"eddi_messages": set(), "eddi_monitor": set(), "eddi_monitor_launcher": set()}
    assert depends(packages) == {"conserta": {KEY}, "consertb": {KEY}} | none
    code = packages / "conserta" / "src" / "conserta" / "EDDIInput.py"
    assert code.read_text("utf-8").count(MINE) == 1

    before = manifests(packages)
    generate(place, "a")  # it is remembered
    assert run("upgrade", "-w", place, "-m", MODEL, cwd=place).status == 0
    assert run("status", "-w", place, cwd=place).status == 0
    assert manifests(packages) == before

    generate(place, "a", "--runtime", "vendored")
    assert (packages / RUNTIME / "src" / RUNTIME / "consert").is_dir()
    assert KEY not in "".join(manifests(packages).values())
    assert code.read_text("utf-8").count(MINE) == 1
    assert run("status", "-w", place, cwd=place).status == 0


def test_edits_of_the_runtime_are_kept_aside(packages: Path) -> None:
    place = packages.parents[1]
    manifest = packages / RUNTIME / "package.xml"
    end = "  <!-- Manual edit end"
    manifest.write_text(manifest.read_text().replace(end, f"  <!-- ours -->\n{end}", 1))
    inputs = packages / RUNTIME / "src" / RUNTIME / "inputs.py"
    inputs.write_text(inputs.read_text("utf-8") + "# ours\n", "utf-8")
    generate(place, "a", "--runtime", "installed", status=3)
    kept = packages / RUNTIME / ".eddi" / "kept"
    left = {path for path in (packages / RUNTIME).rglob("*") if path.is_file()}
    saved = {kept / "package.own.region", kept / "src" / RUNTIME / "inputs.py"}
    assert left == saved
    assert all("ours" in path.read_text("utf-8") for path in saved)
    generate(place, "a")
    generate(place, "a", "--runtime", "vendored", status=3)  # until somebody removes the file
    assert "<!-- ours -->" in manifest.read_text()
    assert "ours" in (kept / "src" / RUNTIME / "inputs.py").read_text("utf-8")
    assert inputs.is_file()


def test_upgrade_takes_away_what_no_monitor_needs(packages: Path) -> None:
    """Such as after plain Copier has changed the answers of the monitors."""
    place = packages.parents[1]
    answers = packages / "conserta" / ".copier-answers.yml"
    text = answers.read_text("utf-8")
    answers.write_text(text.replace("runtime: vendored", "runtime: installed"), "utf-8")
    assert run("status", "-w", place, cwd=place).status == 1
    assert run("upgrade", "-w", place, cwd=place).status == 0
    assert not (packages / RUNTIME).exists()
    assert KEY in manifests(packages)["conserta"]


def test_a_plain_package(tmp_path: Path) -> None:
    package = plain(tmp_path, "--runtime", "installed")
    runtime = package.with_name(RUNTIME)
    assert not runtime.exists()
    assert f'dependencies = ["eddi-runtime>={__version__}"]' in (
        package / "pyproject.toml"
    ).read_text("utf-8")
    plain(tmp_path)
    assert not runtime.exists()
    code = package / "EDDIInput.py"
    first = code.read_text("utf-8")
    code.write_text(first.replace("self.RtE_A_E0 = RtE_A_E0", "self.RtE_A_E0 = 1 == 1"), "utf-8")
    plain(tmp_path, "--runtime", "vendored")
    text = code.read_text("utf-8")
    assert (runtime / "consert").is_dir()
    assert "self.RtE_A_E0 = 1 == 1" in text
    plain(tmp_path, "--runtime", "installed")
    assert not runtime.exists()


def test_plain_packages_have_one_runtime(tmp_path: Path) -> None:
    """It has what any of them needs."""
    plain(tmp_path)
    events = ROOT / "examples/motor-watch"
    words = ("-m", events / "motor_watch.events", "-c", events / "motor_config.yml")
    done = run("generate", *words, "-o", tmp_path, "--platform", "plain", cwd=tmp_path)
    steps = " ".join(done.err.replace("\\\n", " ").split())  # a long line goes on below
    assert f"pip install {tmp_path}/eddi_runtime {tmp_path}/motor_watch" in steps
    parts = {path.stem for path in (tmp_path / RUNTIME).iterdir()}
    assert {"consert", "event", "expressions"} <= parts
    assert not {"bayesian_network", "node", "transports"} & parts


def test_no_other_place_is_known(tmp_path: Path) -> None:
    done = run("generate", "-m", MODEL, "-o", "o", "--runtime", "somewhere", cwd=tmp_path)
    assert done.status == 2
    assert "'somewhere' is not one of 'vendored', 'installed'" in done.err
    assert not list(tmp_path.iterdir())


def test_the_templates_ask_for_this_version() -> None:
    """What they write is for the runtime beside them; an older one may lack what it needs."""
    text = (ROOT / "copier_templates" / "questions" / "runtime.yml").read_text("utf-8")
    assert jinja2.Template(yaml.safe_load(text)["runtime_version"]["default"]).render() == (
        __version__
    )


def own_files(packages: Path) -> dict[str, str]:
    """Return the texts that one process adds or changes, without records."""
    host = f"src/eddi_runtime/{HOST}.py"
    names = ("launch/eddi.launch", "CMakeLists.txt", "scripts/*.py", "src/*/RosNode.py", host)
    found = (path for name in names for path in packages.glob(f"*/{name}"))
    return {path.relative_to(packages).as_posix(): path.read_text("utf-8") for path in found}


def test_one_process_comes_and_goes_for_all_monitors(packages: Path) -> None:
    place, separate = packages.parents[1], own_files(packages)
    generate(place, "b", "--single-process")
    joined = own_files(packages)
    added = {f"{name}/src/{name}/RosNode.py" for name in ("conserta", "consertb")}
    added |= {f"eddi_runtime/src/eddi_runtime/{HOST}.py"}
    added |= {"eddi_monitor_launcher/scripts/EDDIMonitors.py"}
    assert added <= joined.keys() - separate.keys()
    launch = packages / "eddi_monitor_launcher" / "launch" / "eddi.launch"
    text = launch.read_text("utf-8")
    assert ('type="EDDIMonitors.py"' in text, "include" in text) == (True, False)
    program = joined["eddi_monitor_launcher/scripts/EDDIMonitors.py"]
    assert program.count("    from conserta import RosNode\n") == 1
    assert "class RosNode(MonitorNode)" in joined["conserta/src/conserta/RosNode.py"]
    assert "class" not in joined["conserta/scripts/RosNode.py"]

    generate(place, "a")  # it is remembered
    assert run("upgrade", "-w", place, "-m", MODEL, cwd=place).status == 0
    assert run("status", "-w", place, cwd=place).status == 0
    assert own_files(packages) == joined

    generate(place, "a", "--separate-processes")
    back = own_files(packages)
    assert all(back[name] == separate[name] for name in separate if "launcher" not in name)
    assert not back.keys() & added
    assert launch.read_text("utf-8").count("<include") == 2
    code = packages / "conserta" / "src" / "conserta" / "EDDIInput.py"
    assert code.read_text("utf-8").count(MINE) == 1
