"""Links, FIFOs, sockets, devices and modes in a workspace that others made."""

from __future__ import annotations

import os
import re
import shutil
import stat
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from eddi_scaffold.packages.transaction import FileState, apply, write
from eddi_scaffold.problems import EddiError
from eddi_scaffold.regions.__main__ import main as regions_tool
from eddi_scaffold.regions.bases import read_bases, write_bases
from eddi_scaffold.regions.manifest import record_bases
from tests.cli.command import Result, example, files_below, run
from tests.diagnosed import assert_example
from tests.hostile import special

pytestmark = pytest.mark.slow

MODEL, CONFIG = "two_conserts.xml", "consert_b_config.yml"
PACKAGE = "consertb"
INPUT = "EDDIInput.py"
DOCSTRING = "One attribute for each input of the monitor."


@pytest.fixture
def limited() -> Iterator[None]:
    with special.limited():
        yield


@pytest.fixture(scope="module")
def generated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A workspace whose package an older template made: its input module has another docstring."""
    folder = example(tmp_path_factory.mktemp("made"))
    made = run("generate", "--platform", "plain", "-o", "ws", "-m", MODEL, "-c", CONFIG, cwd=folder)
    assert made.status == 0, made.err
    package = folder / "ws" / PACKAGE
    make_older(package, INPUT)
    (package / "README.md").unlink()
    return folder


def make_older(package: Path, name: str) -> None:
    """Put what another template would have rendered into a file and its base."""
    text = (package / name).read_text()
    assert DOCSTRING in text
    older = text.replace(DOCSTRING, "Attributes.")
    (package / name).write_text(older)
    write_bases(package, {**read_bases(package), name: older})
    record_bases(package, {name: older})


@pytest.fixture
def package(generated: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(generated, tmp_path / "clone"), "ws", PACKAGE)


@pytest.fixture
def outside(tmp_path: Path) -> Path:
    folder = tmp_path / "outside"
    folder.mkdir()
    return folder


def upgrade(package: Path, *words: object) -> Result:
    return run("upgrade", "-w", package.parent, *words, cwd=package.parents[1])


def status(package: Path) -> Result:
    return run("status", "-w", package.parent, cwd=package.parents[1])


def states(folder: Path) -> dict[str, tuple[int, int, bytes | str]]:
    """Return all that stands below a folder: mode, time of change, content or target."""
    found: dict[str, tuple[int, int, bytes | str]] = {}
    for path in sorted(folder.rglob("*")):
        kind = path.lstat()
        content: bytes | str = ""
        if stat.S_ISREG(kind.st_mode) and kind.st_size < 1 << 20:
            content = path.read_bytes()
        elif stat.S_ISLNK(kind.st_mode):
            content = str(path.readlink())
        found[str(path.relative_to(folder))] = (kind.st_mode, kind.st_mtime_ns, content)
    return found


def render_anew(package: Path) -> None:
    """Do what Copier does before it starts the merge."""
    for name, base in read_bases(package).items():
        place = package / ".eddi/pristine" / name
        place.parent.mkdir(parents=True, exist_ok=True)
        text = base.replace("Attributes.", DOCSTRING)
        place.write_text(f"{text}# x: end of rendering\n")


def move_out(place: Path, outside: Path) -> None:
    """Leave a link in the place of what is outside from now on."""
    place.rename(outside / place.name)
    place.symlink_to(outside / place.name)


def was_upgraded(package: Path) -> bool:
    """Tell whether the rest of the package was brought up to date."""
    return (package / "README.md").exists()


# what is a person's own ---------------------------------------------------------------------------
def a_link(package: Path) -> str:
    (package / "data").symlink_to("/usr")
    return "data (a link)"


def a_link_to_everything(package: Path) -> str:
    (package / "x").symlink_to("/")
    return "x (a link)"


def a_link_to_itself(package: Path) -> str:
    (package / "loop").symlink_to("loop")
    (package / "here").symlink_to(".")
    return "here (a link), loop (a link)"


def a_lock_file(package: Path) -> str:
    (package / f".#{INPUT}").symlink_to("somebody@somewhere.4711")
    return f".#{INPUT} (a link)"


def a_fifo(package: Path) -> str:
    os.mkfifo(package / "pipe")
    return "pipe (a FIFO)"


def a_socket(package: Path) -> str:
    special.a_socket(package / "talk")
    return "talk (a socket)"


def a_large_file(package: Path) -> str:
    with (package / "recording.bag").open("wb") as file:
        file.truncate(1 << 33)
    return "recording.bag (a file that cannot be read (it has more than the limit of 67108864 bytes"


def a_name_of_two_lines(package: Path) -> str:
    (package / "a\nleft alone: b").symlink_to("/")
    return r"'a\nleft alone: b' (a link)"


@pytest.mark.parametrize(
    "make",
    [
        a_link, a_link_to_everything, a_link_to_itself, a_lock_file, a_fifo, a_socket, a_large_file,
        a_name_of_two_lines,
    ],
)  # fmt: skip
def test_what_is_a_persons_own_stays_and_is_said_once(
    package: Path, make: Callable[[Path], str], limited: None
) -> None:
    said = make(package)
    own = states(package)
    result = upgrade(package)
    assert result.status == 0, result.err
    assert result.err.count(f"{PACKAGE}: left as they are: {said}") == 1
    assert was_upgraded(package)
    assert DOCSTRING in (package / INPUT).read_text()
    after = states(package)
    for name, state in own.items():
        if not stat.S_ISREG(state[0]) and not stat.S_ISDIR(state[0]):
            assert after[name] == state
    assert status(package).status == 0


# editable files that are links --------------------------------------------------------------------
HAND = "        self.RtE_A_E0 = 7  # mine\n"


def leads_to(package: Path, place: Path) -> Path:
    """Leave a link in the place of the edited module, which is another file from now on."""
    text = (package / INPUT).read_text()
    body = re.compile(
        r"(?<=RtE_A_E0 sig: 81fdda7e\n).*?(?=^ *'''-----Manual edit end)", re.MULTILINE | re.DOTALL
    )
    assert len(body.findall(text)) == 1
    place.parent.mkdir(parents=True, exist_ok=True)
    place.write_text(body.sub(HAND, text))
    place.chmod(0o600)
    (package / INPUT).unlink()
    (package / INPUT).symlink_to(os.path.relpath(place, package))
    return place


def generate(package: Path) -> Result:
    words = ("generate", "--platform", "plain", "-o", "ws", "-m", MODEL, "-c", CONFIG)
    return run(*words, cwd=package.parents[1])


def sync(package: Path) -> Result:
    """Do what plain Copier does after a rendering."""
    render_anew(package)
    return Result(regions_tool(["sync"], package), "", "")


def is_merged(package: Path, place: Path) -> bool:
    assert (package / INPUT).is_symlink()
    text = place.read_text()
    assert text.count(HAND) == 1
    assert place.stat().st_mode & 0o777 == 0o600
    return DOCSTRING in text


@pytest.mark.parametrize("command", [upgrade, generate, sync])
@pytest.mark.parametrize("name", [f"mine/{INPUT}", "hand.py", f"a/b/{INPUT}"])
def test_a_link_to_an_own_file_of_the_package_gets_the_merge(
    package: Path, command: Callable[[Path], Result], name: str
) -> None:
    place = leads_to(package, package / name)
    result = command(package)
    assert result.status == 0, result.err
    assert is_merged(package, place)
    assert command(package).status == 0
    if command is not sync:  # which has no rendering of the other files
        assert status(package).status == 0


@pytest.mark.parametrize("command", [upgrade, generate])
def test_a_link_to_another_folder_of_the_workspace_gets_the_merge(
    package: Path, command: Callable[[Path], Result]
) -> None:
    place = leads_to(package, package.parent / "hand/rover.py")
    result = command(package)
    assert result.status == 0, result.err
    assert is_merged(package, place)


def test_a_link_out_of_the_packages_of_a_catkin_workspace_gets_the_merge(tmp_path: Path) -> None:
    folder = tmp_path / "clone"
    folder.mkdir()
    example(folder)
    (folder / "ws/src").mkdir(parents=True)
    words = ("generate", "-w", "ws", "-m", MODEL, "-c", CONFIG)
    assert run(*words, cwd=folder).status == 0
    package = folder / "ws/src/eddi_monitor" / PACKAGE
    make_older(package, f"src/{PACKAGE}/{INPUT}")
    place = leads_to(package / "src" / PACKAGE, folder / "ws/src/hand/scripts/rover.py")
    before = files_below(folder)
    named = run("upgrade", package, cwd=folder)
    assert (named.status, "is a link: it is left alone" in named.err) == (3, True)
    assert files_below(folder)["ws/src/hand/scripts/rover.py"] == place.read_bytes()
    assert before.keys() == files_below(folder).keys()
    assert run("upgrade", "-w", "ws", cwd=folder).status == 0
    assert is_merged(package / "src" / PACKAGE, place)
    assert not list((folder / "ws").rglob(".eddi-*"))


@pytest.mark.parametrize("command", [upgrade, generate, sync])
def test_a_link_out_of_what_was_named_is_left_alone(
    package: Path, outside: Path, command: Callable[[Path], Result]
) -> None:
    place = leads_to(package, outside / INPUT)
    before = states(outside)
    assert command(package).status == (0 if command is sync else 3)
    assert states(outside) == before
    assert place.read_text().count(HAND) == 1


@pytest.mark.parametrize("target", [f"{PACKAGE}/README.md", "own.py", f"{PACKAGE}/.eddi/x"])
def test_a_link_to_what_is_not_this_file_is_left_alone(package: Path, target: str) -> None:
    """A stranger's package cannot name a file of a person, nor one of ours."""
    place = package.parent / target
    place.write_text("mine = 1\n")
    (package / INPUT).unlink()
    (package / INPUT).symlink_to(os.path.relpath(place, package))
    result = upgrade(package)
    assert result.status == 3
    assert f"{INPUT} is a link: it is left alone" in result.err
    if target == "own.py":
        assert place.read_text() == "mine = 1\n"


def test_a_link_into_a_linked_folder_of_the_package_is_no_way_out(
    package: Path, outside: Path
) -> None:
    place = leads_to(package, outside / INPUT)
    (package / "inner").symlink_to(outside)
    (package / INPUT).unlink()
    (package / INPUT).symlink_to(f"inner/{INPUT}")
    before = place.read_bytes()
    assert upgrade(package).status == 3
    assert place.read_bytes() == before


def test_two_links_to_one_file_are_merged_once(package: Path) -> None:
    place = leads_to(package, package.parent / "hand/rover.py")
    shutil.copytree(package, package.with_name("other"), symlinks=True)
    result = upgrade(package)
    assert result.status == 3
    assert result.err.count(f"other/{INPUT} is a link: it is left alone") == 1
    assert is_merged(package, place)


def test_a_link_that_leads_nowhere_stops_nothing(package: Path) -> None:
    (package / INPUT).unlink()
    (package / INPUT).symlink_to("gone.py")
    assert upgrade(package).status == 3
    assert was_upgraded(package)
    assert (package / INPUT).is_symlink()


# links that lead out of the package ---------------------------------------------------------------
@pytest.mark.parametrize("name", [INPUT, "model.json", "EDDIMonitor.py", "test", "eddi_runtime"])
def test_what_stands_behind_a_link_is_not_written(package: Path, outside: Path, name: str) -> None:
    move_out(package / name, outside)
    for file in outside.rglob("*.*"):
        file.chmod(0o600)
        file.write_text(f"{file.read_text()}\n# mine\n")
    before = states(outside)
    look = status(package)
    assert look.status == 1
    assert f"look at: {PACKAGE}/{name} is a link: it is left alone" in look.out
    result = upgrade(package)
    assert result.status == 3
    assert result.err.count(f"left alone: {PACKAGE}/{name} is a link: it is left alone") == 1
    assert states(outside) == before
    assert (package / name).is_symlink()
    assert was_upgraded(package)


def test_the_merge_goes_on_when_the_link_is_gone(package: Path, outside: Path) -> None:
    move_out(package / INPUT, outside)
    assert upgrade(package).status == 3
    (package / INPUT).unlink()
    text = (outside / INPUT).read_text().replace("import", "import math\nimport", 1)
    (package / INPUT).write_text(text)
    assert upgrade(package).status == 0
    after = (package / INPUT).read_text()
    assert "import math\n" in after
    assert DOCSTRING in after


def test_an_own_file_behind_a_link_in_the_package_is_not_lost(package: Path) -> None:
    (package / "own.py").write_text("own = 1\n")
    (package / "README.md").symlink_to("own.py")
    assert upgrade(package).status == 3
    assert (package / "own.py").read_text() == "own = 1\n"


@pytest.mark.parametrize("make", [a_fifo, a_socket])
@pytest.mark.parametrize("name", [INPUT, "README.md"])
def test_a_special_file_in_the_place_of_ours_waits(
    package: Path, make: Callable[[Path], str], name: str, limited: None
) -> None:
    what = make(package).partition(" (")
    (package / name).unlink(missing_ok=True)
    (package / what[0]).rename(package / name)
    assert status(package).status == 1
    result = upgrade(package)
    assert result.status == 3
    assert f"{PACKAGE}/{name} is {what[2].rstrip(')')}: it is left alone" in result.err
    assert not stat.S_ISREG((package / name).stat().st_mode)


@pytest.mark.parametrize(
    "name",
    [
        ".eddi", ".eddi/bases", ".eddi/pristine", f".eddi/pristine/{INPUT}",
        ".eddi/manifest.json", ".eddi/generated", ".copier-answers.yml",
    ],
)  # fmt: skip
def test_records_behind_a_link_are_none(package: Path, outside: Path, name: str) -> None:
    (package / ".eddi/generated").mkdir()  # a command on its way has both
    render_anew(package)
    move_out(package / name, outside)
    (outside / "notes.txt").write_text("mine")
    before = states(outside), states(package)
    result = upgrade(package)
    assert result.status == 3
    assert f"left alone: {PACKAGE} is left alone: {PACKAGE}/{name} is a link" in result.err
    assert status(package).status == 1
    assert (states(outside), states(package)) == before


def test_a_package_that_is_a_link_is_left_alone(package: Path, outside: Path) -> None:
    move_out(package, outside)
    before = states(outside)
    said = f"left alone: {PACKAGE} is a link: it is left alone; name the folder that it leads to"
    for words in (["-w", package.parent], [package]):
        result = run("upgrade", *words, cwd=package.parents[1])
        assert (result.status, result.err.count(said)) == (3, 1)
        assert run("status", *words, cwd=package.parents[1]).status == 1
    words = ("generate", "--platform", "plain", "-o", "ws", "-m", MODEL, "-c", CONFIG)
    result = run(*words, cwd=package.parents[1])
    assert (result.status, result.err.count(said)) == (3, 1)
    assert states(outside) == before


def test_records_that_are_everything_are_not_walked(package: Path, limited: None) -> None:
    shutil.rmtree(package / ".eddi")
    (package / ".eddi").symlink_to("/")
    assert run("regions", "--check", package, cwd=package).status == 3
    assert upgrade(package).status == 3
    assert regions_tool(["check"], package) == 1


def test_a_link_to_a_package_beside_it_blocks_nothing(package: Path) -> None:
    (package.parent / "alias").symlink_to(PACKAGE)
    result = upgrade(package, "-m", MODEL)
    assert result.status == 3
    assert "left alone: alias is a link" in result.err
    assert was_upgraded(package)


@pytest.mark.parametrize("link", ["src", "src/eddi_monitor"])
def test_a_workspace_whose_folders_lie_elsewhere(tmp_path: Path, outside: Path, link: str) -> None:
    folder = tmp_path / "clone"
    folder.mkdir()
    example(folder)
    (folder / "ws/src").mkdir(parents=True)
    words = ("generate", "-w", "ws", "-m", MODEL, "-c", CONFIG)
    assert run(*words, cwd=folder).status == 0
    move_out(folder / "ws" / link, outside)
    next(outside.rglob("Guarantee.msg")).write_text("string other\n")
    before = states(outside)
    for command in (words, ("upgrade", "-w", "ws"), ("status", "-w", "ws")):
        result = run(*command, cwd=folder)
        assert result.status == 2
        assert_example("F011", result.err)
    assert states(outside) == before


def test_nothing_is_written_behind_a_link(tmp_path: Path, outside: Path) -> None:
    root = tmp_path / "root"
    root.mkdir()
    (root / "link").symlink_to(outside)
    os.mkfifo(root / "pipe")
    with pytest.raises(OSError, match="a link is in the way"):
        apply(root, {"a": FileState(b"a"), "link/b": FileState(b"b")}, {})
    (root / "null").symlink_to("/dev/null")
    for name, kind in {"pipe": "a FIFO", "null": "a device"}.items():
        with pytest.raises(EddiError) as refused:
            write(root, {"a": FileState(b"a"), name: FileState(b"b")}, {})
        (problem,) = refused.value.problems
        assert (problem.code, problem.message) == (
            "F002",
            f"cannot write: {kind} is in its place",
        )
    assert sorted(path.name for path in root.iterdir()) == ["link", "null", "pipe"]
    assert list(outside.iterdir()) == []


# modes --------------------------------------------------------------------------------------------
@pytest.mark.parametrize("mode", [0o600, 0o640, 0o664, 0o444, 0o755, 0o700])
def test_modes_stay(package: Path, mode: int) -> None:
    names = [INPUT, "EDDIMonitor.py", "model.json"]
    for name in names:
        (package / name).chmod(mode)
    (package / "EDDIMonitor.py").write_text("# older\n")
    answers = package / ".eddi" / "manifest.json"
    answers.chmod(mode)
    assert upgrade(package).status == 3  # the older text is kept, which is said
    assert {(package / name).stat().st_mode & 0o777 for name in names} == {mode}
    assert answers.stat().st_mode & 0o777 == mode
    assert (package / "EDDIMonitor.py").read_text() != "# older\n"
    assert (package / "README.md").stat().st_mode & 0o777 == 0o644


def test_a_program_can_be_run_again_by_those_who_can_read_it(tmp_path: Path) -> None:
    folder = tmp_path / "clone"
    folder.mkdir()
    example(folder)
    (folder / "ws/src").mkdir(parents=True)
    words = ("generate", "-w", "ws", "-m", MODEL, "-c", CONFIG)
    assert run(*words, cwd=folder).status == 0
    program = folder / "ws/src/eddi_monitor" / PACKAGE / "scripts/RosNode.py"
    assert program.stat().st_mode & 0o777 == 0o755
    program.chmod(0o640)
    assert run("upgrade", "-w", "ws", cwd=folder).status == 0
    assert program.stat().st_mode & 0o777 == 0o750


# the tool that Copier starts, and `regions` -------------------------------------------------------
@pytest.mark.parametrize(
    "name",
    [
        ".eddi", ".eddi/base", ".eddi/pristine", ".eddi/orphans", ".eddi/rejects",
        ".eddi/bases", f".eddi/next/{INPUT}", INPUT,
    ],
)  # fmt: skip
def test_sync_writes_and_deletes_nothing_behind_a_link(
    package: Path, outside: Path, name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    render_anew(package)
    if not (package / name).exists():
        place = package / name
        place.parent.mkdir(exist_ok=True)
        place.write_text("x") if name.endswith(".py") else place.mkdir()
    move_out(package / name, outside)
    (outside / "notes.txt").write_text("mine")
    if (outside / name.rpartition("/")[2]).is_dir():
        (outside / name.rpartition("/")[2] / "notes.txt").write_text("mine")
    before = states(outside)
    regions_tool(["check"], package)
    assert regions_tool(["sync"], package) == 0
    assert f"{name}:1: error: " in capsys.readouterr().err.replace(str(package) + "/", "")
    assert states(outside) == before


def test_a_temporary_file_of_ours_is_none_of_theirs(package: Path, outside: Path) -> None:
    (outside / "notes.txt").write_text("mine")
    (package / f".{INPUT}.eddi-tmp").symlink_to(outside / "notes.txt")
    text = (package / INPUT).read_text()
    (package / INPUT).write_text(text.replace("sig: 81fdda7e", "sig: 00000000", 1))
    result = run("regions", "--accept", "input:RtE_A_E0", package, cwd=package)
    assert result.status == 0, result.err
    assert (package / INPUT).read_text() == text
    assert (outside / "notes.txt").read_text() == "mine"


def test_accept_writes_nothing_behind_a_link(package: Path, outside: Path) -> None:
    text = (package / INPUT).read_text()
    (package / INPUT).write_text(text.replace("sig: 81fdda7e", "sig: 00000000", 1))
    move_out(package / INPUT, outside)
    before = states(outside)
    assert run("regions", "--accept", "input:RtE_A_E0", package, cwd=package).status == 2
    assert states(outside) == before
