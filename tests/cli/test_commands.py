"""Every command as a user meets it: exit status, what goes where, JSON, colours, lost readers."""

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from eddi_scaffold import __version__
from eddi_scaffold.cli.console import ExitStatus
from tests.cli.command import ROOT, Result, edit, example, files_below, run
from tests.data_files import tabled
from tests.diagnosed import assert_reported

pytestmark = pytest.mark.slow

COMMANDS = [
    *("example", "check", "show", "run", "generate"),
    *("connect", "parse-rossystem", "regions", "status", "upgrade", "watch", "explain"),
    *("diagram", "compose", "export", "event", "trace"),
    *("verify", "inject", "report"),
    *("adopt", "answers"),
]
MODEL = "two_conserts.xml"
PLAIN = ("generate", "--platform", "plain", "-o", "out", "-m", MODEL, "--name", "ConSertB")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return example(tmp_path)


@pytest.fixture
def package(folder: Path) -> Path:
    assert run(*PLAIN, cwd=folder).status == 0
    return folder / "out" / "consertb"


def started(*words: object, cwd: Path, **options: object) -> subprocess.Popen[bytes]:
    """Start the real program."""
    environment = {**os.environ, "PYTHONPATH": f"{ROOT}:{ROOT / 'runtime_lib' / 'src'}"}
    environment |= options.pop("env", {})
    return subprocess.Popen(
        [sys.executable, "-m", "eddi_scaffold", *map(str, words)],
        cwd=cwd,
        env=environment,
        **{"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **options},
    )


def finished(*words: object, cwd: Path, **options: object) -> Result:
    process = started(*words, cwd=cwd, **options)
    out, err = process.communicate(timeout=60)
    return Result(process.returncode, (out or b"").decode(), (err or b"").decode())


# help, version, usage


@pytest.mark.parametrize("command", COMMANDS)
def test_the_help_of_a_command_has_an_example(command: str, tmp_path: Path) -> None:
    short, long = (run(command, flag, cwd=tmp_path) for flag in ("-h", "--help"))
    assert short == long
    assert (short.status, short.err) == (0, "")
    assert f"Example: eddi-scaffold {command} " in short.out


def test_help_lists_the_commands_by_when_they_are_needed(tmp_path: Path) -> None:
    result = run("--help", cwd=tmp_path)
    assert (result.status, result.err) == (0, "")
    listed = result.out.partition("Start here:\n")[2].partition("  Start with:")[0]
    assert re.findall(r"(?m)^  (\S+)  ", listed) == COMMANDS
    assert "..." not in listed  # no line is cut
    assert "eddi-scaffold example two-conserts demo" in " ".join(result.out.split())


@tabled
def test_wrong_usage(words: list[str], said: str, tmp_path: Path) -> None:
    result = run(*words, cwd=tmp_path)
    assert (result.status, result.out) == (2, "")
    assert said in result.err
    assert "Traceback" not in result.err


# data, words, JSON


def test_an_example_links_only_to_what_is_written_with_it() -> None:
    for readme in (ROOT / "examples").glob("*/README.md"):
        for link in re.findall(r"\]\(([^)]*)\)", readme.read_text("utf-8")):
            assert ".." not in link, readme
            assert (readme.parent / link).is_file(), readme


def test_show_says_with_its_status_that_a_model_is_not_whole(folder: Path) -> None:
    text = (folder / MODEL).read_text()
    broken = text.replace('target="//@odeProductPackages.0/@conSerts.1/@guarantees.0"', "", 1)
    (folder / MODEL).write_text(broken)
    result = run("show", MODEL, cwd=folder)
    assert result.status == 1
    assert "ConSert ConSertA" in result.out
    assert "error" in result.err
    assert run("show", MODEL, "--json", cwd=folder).status == 1


@tabled
def test_every_failure_can_be_json(words: list[str], folder: Path) -> None:
    result = run(*words, "--json", cwd=folder)
    assert (result.status, result.err) == (2, "")
    found = json.loads(result.out)
    assert list(found) == ["problems"]
    assert {problem["level"] for problem in found["problems"]} == {"error"}


def test_json_is_ascii_so_that_every_terminal_can_hold_it(folder: Path) -> None:
    result = finished(
        "check", "nöthere.xml", "--json", cwd=folder, env={"PYTHONIOENCODING": "ascii"}
    )
    assert json.loads(result.out)["problems"][0]["file"] == "nöthere.xml"


# packages


def test_status_and_regions_of_a_fresh_package(package: Path, folder: Path) -> None:
    status = run("status", package, "--json", cwd=folder)
    assert status.status == 0
    (state,) = json.loads(status.out)["packages"]
    assert (state["package"], state["drifted"]) == ("consertb", False)
    assert state["regions"] == {"untouched": 7}
    for words in (("status", "."), ("status",)):
        printed = run(*words, cwd=package)
        assert printed == Result(0, "consertb: up to date (regions: 7 untouched)\n", "")
    assert run("trace", cwd=package) == run("trace", ".", cwd=package)
    (package / "compiled.py").write_text("# by hand\n")
    assert run("upgrade", cwd=package).status == 3
    assert "def " in (package / "compiled.py").read_text()


def test_packages_are_found_where_generate_was_told_to_put_them(
    package: Path, folder: Path
) -> None:
    for command in ("status", "trace", "regions", "upgrade"):
        results = {run(command, word, "out", cwd=folder) for word in ("-w", "-o", "--output")}
        assert [(one.status, "[U001]" in one.err) for one in results] == [(0, False)], command


def test_hand_edits_that_need_a_look_are_3(package: Path, folder: Path) -> None:
    edit(package / "EDDIInput.py", "= RtE_A_E0", "= bool(RtE_A_E0)")
    text = (folder / MODEL).read_text().replace('"RtE_A_E0"', '"RtE_A_E9"')
    (folder / "v2.xml").write_text(text)
    told = "note: consertb/.eddi/kept/process_RtE_A_E0.region: "
    for times in (0, 1, 1):  # that it goes there is told already the first time
        result = run("upgrade", package, "-m", "v2.xml", cwd=folder)
        assert (result.status, result.err.count(told)) == (3, times), result.err
        assert "hand edits need a look" in result.err
        if times:  # rendered again, and nothing new happens to hand edits
            (package / "EDDIMonitor.py").unlink()
    assert run("regions", package, "--check", cwd=folder).status == 3
    kept = [data for name, data in files_below(package).items() if "kept" in name]
    assert b"bool(RtE_A_E0)" in b"".join(kept)


# global options


def test_quiet_and_verbose(folder: Path) -> None:
    assert run("check", "-q", MODEL, cwd=folder) == Result(0, "", "")
    assert run("-q", "check", "nothere", cwd=folder).err.count("\n") == 1
    assert "[S007]" in run("check", MODEL, "--verbose", cwd=folder).err
    normal = run("check", MODEL, cwd=folder)
    assert normal.err == f"no problems in {MODEL} (-v shows 2 infos)\n"


@tabled
def test_colour(flag, environment, coloured, tmp_path, monkeypatch):
    for name in ("NO_COLOR", "FORCE_COLOR"):
        monkeypatch.setenv(name, "1" if name in environment.split() else "")
    result = run("check", "nothere", flag, cwd=tmp_path)
    assert ("\x1b[" in result.err) is coloured
    assert "error:" in result.err


def test_text_of_a_file_cannot_steer_the_terminal(tmp_path: Path) -> None:
    (tmp_path / "c.yml").write_text('Model: {id: A, type: "\\e[2J\\a\\n"}\n')
    (tmp_path / "m.yml").write_text("\x1b[2J: 1\n")
    name = "a\nb\x1b[2J.xml"
    result = run("check", "c.yml", "m.yml", name, cwd=example(tmp_path))
    assert "\x1b" not in result.err
    assert "\x07" not in result.err
    assert "a b\\x1b[2J.xml: error:" in result.err


# what can happen to a process


def test_a_reader_that_has_gone_does_not_change_the_answer(folder: Path) -> None:
    for words, status in ((["show", MODEL], 0), (["compose", "ConSertA.yml"], 1)):
        run("export", MODEL, "-o", ".", cwd=folder)
        read, write = os.pipe()
        os.close(read)
        result = finished(*words, cwd=folder, stdout=write)
        os.close(write)
        assert (result.status, result.err) == (status, "")


def test_a_closed_output_is_no_bug(folder: Path) -> None:
    for stream in (1, 2):
        process = started("check", "nothere", cwd=folder, preexec_fn=lambda fd=stream: os.close(fd))
        _, err = process.communicate(timeout=60)
        assert (process.returncode, b"bug" in err) == (1, False)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no /dev/full")
def test_data_that_cannot_be_written_is_an_error(folder: Path) -> None:
    with Path("/dev/full").open("wb") as full:
        result = finished("show", MODEL, cwd=folder, stdout=full)
    assert result.status == 2
    assert_reported("F002", result.err)


def test_ctrl_c_while_it_loads(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "eddi_scaffold.cli.app", Interrupting())
    assert run("show", MODEL, cwd=folder) == Result(
        130, "", "interrupted, nothing is half-written\n"
    )


@pytest.mark.parametrize("when", ["atexit.register", "threading._register_atexit"])
def test_ctrl_c_while_python_ends(when: str, folder: Path) -> None:
    itself = "os.kill, os.getpid(), signal.SIGINT"
    program = (
        f"import atexit, os, signal, threading; {when}({itself})\n"
        "from eddi_scaffold.__main__ import program"
    )
    environment = {**os.environ, "PYTHONPATH": f"{ROOT}:{ROOT / 'runtime_lib' / 'src'}"}
    command = [sys.executable, "-c", program, "check", "-q", str(MODEL)]
    done = subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


class Interrupting:
    """A module whose loading is interrupted."""

    def __getattr__(self, name: str) -> object:
        raise KeyboardInterrupt


def test_what_the_system_refuses_is_no_bug(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied", "somewhere")

    monkeypatch.setattr("eddi_scaffold.deployments.checking.check_files", refuse)
    result = run("check", MODEL, cwd=folder)
    assert result.status == 2
    assert_reported("F001", result.err)


def test_a_bug_is_one_line_unless_more_is_asked(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object, **__: object) -> None:
        raise ZeroDivisionError("so that")

    monkeypatch.setattr("eddi_scaffold.deployments.checking.check_files", fail)
    result = run("check", "-q", MODEL, cwd=folder)
    assert (result.status, result.out) == (ExitStatus.OUR_BUG, "")
    assert f"this is a bug in eddi-scaffold {__version__}: ZeroDivisionError: so that" in result.err
    assert "Traceback" not in result.err
    assert "Traceback" in run("check", MODEL, "--traceback", cwd=folder).err


def test_a_folder_is_checked_file_by_file(tmp_path: Path) -> None:
    example(tmp_path)
    (tmp_path / "docker-compose.yml").write_text("services: {}\n")
    (tmp_path / "package.xml").write_text("<package/>\n")
    (tmp_path / "broken.yml").write_text("a: [\n")
    found = run("check", ".", cwd=tmp_path)
    assert found.status == 1
    assert found.err.startswith("broken.yml:2:1: error")
    assert "\nnot checked: README.md, docker-compose.yml, package.xml, recording" in found.err
    assert "in broken.yml, consert_a_config.yml, consert_b_config.yml, two_conserts" in found.err


@tabled
def test_no_output_is_written_over_an_input(words, tmp_path):
    """Whatever its name, and where only a configuration names it."""
    example(tmp_path)
    run("export", "two_conserts.xml", "-o", ".", cwd=tmp_path)
    config = (tmp_path / "consert_a_config.yml").read_text()
    named = config.replace("Model:", "Model:\n  parameters: [{model: ConSertA.yml}]", 1)
    (tmp_path / "named.yml").write_text(named)
    for name, of in (("conserta.yml", "ConSertA.yml"), ("model.svg", MODEL)):
        shutil.copy(tmp_path / of, tmp_path / name)
    (tmp_path / "linked.yml").symlink_to("consert_a_config.yml")
    before = files_below(tmp_path)
    told = run(*words, cwd=tmp_path)
    assert (told.status, told.out) == (2, "")
    assert "is an input of the command" in told.err
    assert files_below(tmp_path) == before
