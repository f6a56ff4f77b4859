"""Links, FIFOs, sockets, devices and modes in a workspace that others made."""

from __future__ import annotations

import os
import shutil
import stat
from pathlib import Path

import pytest

from eddi_scaffold.common.problems import EddiError
from eddi_scaffold.packages.transaction import write
from eddi_scaffold.regions.__main__ import main as regions_tool
from tests.cli.command import Result, example, run
from tests.diagnosed import assert_reported
from tests.hostile import special
from tests.hostile.watch import look

pytestmark = pytest.mark.slow

MODEL, CONFIG = "two_conserts.xml", "consert_b_config.yml"
PACKAGE = "consertb"
INPUT = "EDDIInput.py"
OLD, NEW = "The sensor of system B is healthy", "The sensor of B is well"
CATKIN = ("generate", "-w", "ws", "-m", MODEL, "-c", CONFIG)
GENERATE = ("generate", "--platform", "plain", "-o", "ws", "-m", MODEL, "-c", CONFIG)


@pytest.fixture(scope="module")
def generated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A workspace that a newer model has not reached yet."""
    folder = example(tmp_path_factory.mktemp("made"))
    made = run(*GENERATE, cwd=folder)
    assert made.status == 0, made.err
    model = (folder / MODEL).read_text()
    assert OLD in model
    (folder / MODEL).write_text(model.replace(OLD, NEW))
    return folder


@pytest.fixture(scope="module")
def catkin(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = example(tmp_path_factory.mktemp("catkin"))
    assert run(*CATKIN, cwd=folder).status == 0
    return folder


@pytest.fixture
def package(generated: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(generated, tmp_path / "clone"), "ws", PACKAGE)


@pytest.fixture
def outside(tmp_path: Path) -> Path:
    folder = tmp_path / "outside"
    folder.mkdir()
    return folder


def generate(package: Path) -> Result:
    return run(*GENERATE, cwd=package.parents[1])


def status(package: Path) -> Result:
    return run("status", "-w", package.parent, cwd=package.parents[1])


def move_out(place: Path, outside: Path) -> None:
    """Leave a link in the place of what is outside from now on."""
    place.rename(outside / place.name)
    place.symlink_to(outside / place.name)


def is_new(package: Path) -> bool:
    """Tell whether the package was brought up to date."""
    return NEW in (package / INPUT).read_text()


def test_what_is_a_persons_own_stays(package: Path, limited: None) -> None:
    links = {"data": "/usr", "x": "/", "loop": "loop", "here": "."}
    links[f".#{INPUT}"] = "somebody@somewhere.4711"  # an editor's lock
    for name, target in links.items():
        (package / name).symlink_to(target)
    os.mkfifo(package / "fifo")
    special.a_socket(package / "socket")
    with (package / "recording.bag").open("wb") as file:
        file.truncate(1 << 33)
    own = look(package)
    result = generate(package)
    assert result.status == 0, result.err
    assert is_new(package)
    after = look(package)
    for name, state in own.items():
        if state.kind not in {stat.S_IFREG, stat.S_IFDIR}:
            assert after[name] == state
    assert status(package).status == 0


@pytest.mark.parametrize(
    "names",
    [
        (INPUT, "ConSertB.yml", "EDDIMonitor.py", "test"),
        (".eddi",),
        (".eddi/manifest",),
        (".eddi/kept",),
        (".copier-answers.yml",),
    ],
)
def test_nothing_is_written_through_a_link_or_over_it(
    package: Path, outside: Path, names: tuple[str, ...]
) -> None:
    for name in names:
        if not (package / name).exists():
            (package / name).mkdir()
        move_out(package / name, outside)
    for file in outside.rglob("*.py"):
        file.chmod(0o600)
        file.write_text(f"{file.read_text()}\n# mine\n")
    before = look(outside), look(package)
    result = generate(package)
    assert result.status == 2
    assert all(f"{name} is a link" in result.err for name in names)
    assert status(package).status != 0
    assert (look(outside), look(package)) == before
    for name in names:
        (package / name).unlink()
        (outside / name.rpartition("/")[2]).rename(package / name)
    result = generate(package)
    assert result.status in {0, 3}, result.err
    assert is_new(package)


def test_what_is_on_its_way_goes_through_no_link(package: Path, outside: Path) -> None:
    (outside / "notes.txt").write_text("mine")
    for name in ("put", "new"):
        (package / ".eddi" / name).symlink_to(outside)
        before = look(outside)
        assert generate(package).status in {0, 2}
        assert look(outside) == before


def test_a_special_file_in_the_place_of_ours_is_refused(package: Path, limited: None) -> None:
    (package / INPUT).unlink()
    os.mkfifo(package / INPUT)
    (package / "README.md").unlink()
    special.a_socket(package / "README.md")
    before = look(package)
    result = generate(package)
    assert result.status == 2
    assert f"{INPUT} is no regular file" in result.err
    assert "README.md is no regular file" in result.err
    assert status(package).status != 0
    assert look(package) == before


def test_a_package_that_is_a_link_is_left_alone(package: Path, outside: Path) -> None:
    move_out(package, outside)
    before = look(outside)
    result = run("upgrade", package, cwd=package.parents[1])
    assert (result.status, f"{PACKAGE} is a link" in result.err) == (2, True)
    assert run("status", package, cwd=package.parents[1]).status == 2
    result = generate(package)
    assert (result.status, f"{PACKAGE} is a link" in result.err) == (2, True)
    assert look(outside) == before


def test_records_that_are_everything_are_not_walked(package: Path, limited: None) -> None:
    shutil.rmtree(package / ".eddi")
    (package / ".eddi").symlink_to("/")
    assert run("regions", "--check", package, cwd=package).status in {0, 3}
    assert generate(package).status == 2
    assert regions_tool(["status", str(package)]) in {0, 3}


def test_a_link_to_a_package_beside_it_blocks_nothing(package: Path) -> None:
    (package.parent / "alias").symlink_to(PACKAGE)
    result = run("upgrade", "-w", package.parent, "-m", MODEL, "-c", CONFIG, cwd=package.parents[1])
    assert result.status == 0
    assert is_new(package)


@pytest.mark.parametrize("link", ["src", "src/eddi_monitor"])
def test_a_workspace_whose_folders_lie_elsewhere(
    catkin: Path, tmp_path: Path, outside: Path, link: str
) -> None:
    folder = Path(shutil.copytree(catkin, tmp_path / "clone"))
    move_out(folder / "ws" / link, outside)
    before = look(outside)
    for command in (CATKIN, ("upgrade", "-w", "ws"), ("status", "-w", "ws")):
        result = run(*command, cwd=folder)
        assert result.status == 2
        assert_reported("F009", result.err)
    assert look(outside) == before


def test_an_output_is_not_written_behind_a_link(tmp_path: Path, outside: Path) -> None:
    root = tmp_path / "root"
    root.mkdir()
    (root / "link").symlink_to(outside)
    os.mkfifo(root / "pipe")
    (root / "null").symlink_to("/dev/null")
    said = {"link/b": "link is a link", "pipe": "pipe is no regular", "null": "null is a link"}
    for name, reason in said.items():
        with pytest.raises(EddiError, match=reason) as refused:
            write(root, {"a": b"a", name: b"b"})
        assert refused.value.problems[0].code == "F002"
    assert sorted(path.name for path in root.iterdir()) == ["link", "null", "pipe"]
    assert list(outside.iterdir()) == []


def test_modes_stay(package: Path) -> None:
    modes = {INPUT: 0o600, "EDDIMonitor.py": 0o444, "ConSertB.yml": 0o664, "compiled.py": 0o755}
    (package / "EDDIMonitor.py").write_text("# older\n")
    for name, mode in modes.items():
        (package / name).chmod(mode)
    assert generate(package).status == 3  # the older text is kept, which is said
    assert {name: (package / name).stat().st_mode & 0o777 for name in modes} == modes
    assert (package / "EDDIMonitor.py").read_text() != "# older\n"


def test_a_program_can_be_run_again_by_those_who_can_read_it(catkin: Path, tmp_path: Path) -> None:
    folder = Path(shutil.copytree(catkin, tmp_path / "clone"))
    program = folder / "ws/src/eddi_monitor" / PACKAGE / "scripts/RosNode.py"
    assert program.stat().st_mode & 0o777 == 0o755
    program.chmod(0o640)
    assert run("upgrade", "-w", "ws", cwd=folder).status == 0
    assert program.stat().st_mode & 0o777 == 0o750


def test_accept_writes_nothing_behind_a_link(package: Path, outside: Path) -> None:
    text = (package / INPUT).read_text()
    looked = text.replace("for:81fdda7e", "for:00000000 now:07d2967b/81fdda7e", 1)
    (package / INPUT).write_text(looked.replace("= RtE_E0.data", "= not RtE_E0.data"))
    place = package / INPUT
    move_out(place, outside)
    before = look(outside)
    accept = ("regions", "--accept", "process_RtE_A_E0", package)
    assert run(*accept, cwd=package).status == 2
    assert look(outside) == before
    place.unlink()
    (outside / INPUT).rename(place)
    assert run(*accept, cwd=package).status == 0
    assert "of:07d2967b for:81fdda7e\n" in place.read_text()
