"""An ``EDDIInput`` of the D7.2 tools pasted over ours: every command that looks names ``adopt``."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cli.command import EXAMPLE, run
from tests.data_files import data_text

BODY = "        self.RtE_A_E0 = RtE_E0.data\n"
MARKED = (
    f"        '''-----Manual edit begin-----'''\n{BODY}        '''-----Manual edit end-----'''\n"
)
TEXT = data_text("packages/pasted.txt")


@pytest.mark.parametrize("body", [BODY, MARKED], ids=["without markers", "with markers"])
def test_adopt_is_named(body: str, tmp_path: Path) -> None:
    sources = ("-m", EXAMPLE / "two_conserts.xml", "-c", EXAMPLE / "consert_b_config.yml")
    assert run("generate", "--platform", "plain", "-o", ".", *sources, cwd=tmp_path).status == 0
    before = run("regions", "--check", ".", cwd=tmp_path)
    assert (before.status, "adopt" in before.out) == (0, False)
    (tmp_path / "consertb" / "EDDIInput.py").write_text(TEXT.replace("BODY\n", body), "utf-8")
    looked = run("regions", "--check", ".", cwd=tmp_path)
    assert looked.status == 3
    assert "`eddi-scaffold adopt OLD_PACKAGE`" in looked.out
    status = run("status", "consertb", cwd=tmp_path)
    assert status.status == 1
    assert "`eddi-scaffold adopt OLD_PACKAGE`" in status.out + status.err


def test_a_recording_is_played_to_it(tmp_path: Path) -> None:
    sources = ("-m", EXAMPLE / "two_conserts.xml", "-c", EXAMPLE / "consert_b_config.yml")
    assert run("generate", "--platform", "plain", "-o", ".", *sources, cwd=tmp_path).status == 0
    (tmp_path / "consertb" / "EDDIInput.py").write_text(TEXT.replace("BODY\n", MARKED), "utf-8")
    (tmp_path / "in.csv").write_text("t,RtE_A_E0\n0.0,true\n0.2,false\n0.4,true\n3.0,\n", "utf-8")
    played = run("run", "consertb", "--inputs", "in.csv", cwd=tmp_path)
    assert played.status == 0, played.err
    states = [line.split()[2] for line in played.out.splitlines()]
    assert states[:3] == ["active", "inactive", "active"]
