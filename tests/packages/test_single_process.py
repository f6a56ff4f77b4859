"""One process for all monitors of a workspace, where somebody asks for it."""

from __future__ import annotations

from pathlib import Path

import pytest

from eddi_scaffold.program.runtime_parts import HOST
from tests.cli.command import EXAMPLE, generate, run

MODEL = EXAMPLE / "two_conserts.xml"
pytestmark = pytest.mark.slow


def own_files(packages: Path) -> dict[str, str]:
    """Return the texts that one process adds or changes, without records."""
    host = f"src/eddi_runtime/{HOST}.py"
    names = ("launch/eddi.launch", "CMakeLists.txt", "scripts/*.py", "src/*/RosNode.py", host)
    found = (path for name in names for path in packages.glob(f"*/{name}"))
    return {path.relative_to(packages).as_posix(): path.read_text("utf-8") for path in found}


def test_it_comes_and_goes_for_all_monitors(tmp_path: Path) -> None:
    (tmp_path / "src").mkdir()
    packages = tmp_path / "src" / "eddi_monitor"
    generate(tmp_path, "a")
    launch = packages / "eddi_monitor_launcher" / "launch" / "eddi.launch"
    code = packages / "conserta" / "src" / "conserta" / "EDDIInput.py"
    mine = "        self.RtE_A_E0 = RtE_E0.data is True\n"
    text = code.read_text("utf-8")
    code.write_text(text.replace("        self.RtE_A_E0 = RtE_E0.data\n", mine), "utf-8")
    separate = own_files(packages)

    generate(tmp_path, "b", "--single-process")
    one = own_files(packages)
    added = {f"{name}/src/{name}/RosNode.py" for name in ("conserta", "consertb")}
    added |= {f"eddi_runtime/src/eddi_runtime/{HOST}.py"}
    added |= {"eddi_monitor_launcher/scripts/EDDIMonitors.py"}
    assert added <= set(one)
    assert not added & set(separate)
    text = launch.read_text("utf-8")
    assert 'type="EDDIMonitors.py"' in text
    assert "include" not in text
    program = one["eddi_monitor_launcher/scripts/EDDIMonitors.py"]
    assert program.count("    from conserta import RosNode\n") == 1
    assert "class RosNode(MonitorNode)" in one["conserta/src/conserta/RosNode.py"]
    assert "class" not in one["conserta/scripts/RosNode.py"]

    generate(tmp_path, "a")  # it is remembered
    assert run("upgrade", "-w", tmp_path, "-m", MODEL, cwd=tmp_path).status == 0
    assert run("status", "-w", tmp_path, cwd=tmp_path).status == 0
    assert own_files(packages) == one

    generate(tmp_path, "a", "--separate-processes")
    back = own_files(packages)
    assert {name: back[name] for name in separate if "launcher" not in name} == {
        name: text for name, text in separate.items() if "launcher" not in name
    }
    assert not set(back) & added
    assert launch.read_text("utf-8").count("<include") == 2
    assert code.read_text("utf-8").count(mine) == 1
