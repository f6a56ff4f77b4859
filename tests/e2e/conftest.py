"""Two workspaces: one as the example ships, one with the hand edits of D7.2; both really built."""

import os
import shutil
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from tests.e2e import edits, models
from tests.e2e.generator import Generator, git
from tests.e2e.robot import CLEAN_PATH, Roscore, Run
from tests.e2e.workspace import Workspace
from tests.ros1.world import why_no_ros

COMMANDS = ("catkin_make", "catkin", "catkin_lint", "roscore", "roslaunch", "rostopic", "rosnode")


@pytest.fixture(scope="session")
def ros_here():
    missing = [name for name in COMMANDS if shutil.which(name, path=CLEAN_PATH) is None]
    reason = why_no_ros() or (f"not installed: {', '.join(missing)}" if missing else None)
    if reason is None:
        return
    if os.environ.get("EDDI_REQUIRE_ROS") == "1":
        pytest.fail(reason)
    pytest.skip(reason)


@pytest.fixture(scope="module")
def folder(ros_here):
    """A folder for everything, in memory where that is possible: git and copier flush a lot."""
    memory = Path("/dev/shm")
    fits = os.access(memory, os.W_OK) and shutil.disk_usage(memory).free > 2**30
    with tempfile.TemporaryDirectory(prefix="eddi-e2e-", dir=memory if fits else None) as name:
        yield Path(name)


@pytest.fixture(scope="module")
def own_git(folder):
    """Keep the tester's git out: a hook's GIT_DIR, signed commits, another owner's checkout."""
    settings = folder / "gitconfig"
    settings.write_text(
        "[user]\nname = Tester\nemail = tester@localhost\n[safe]\ndirectory = *\n"
        "[init]\ndefaultBranch = main\n"
    )
    with pytest.MonkeyPatch.context() as patch:
        for name in [name for name in os.environ if name.startswith(("GIT_", "COPIER_"))]:
            patch.delenv(name)
        patch.setenv("GIT_CONFIG_GLOBAL", str(settings))
        patch.setenv("GIT_CONFIG_NOSYSTEM", "1")
        yield


@pytest.fixture(scope="module")
def home(folder):
    (folder / "home").mkdir()
    return folder / "home"


@pytest.fixture(scope="module")
def generator(folder, own_git):
    return Generator(folder / "eddi-scaffold")


@pytest.fixture(scope="module")
def shipped(generator, folder, home):
    """The example as it is: no hand edit is needed."""
    workspace = Workspace(folder / "shipped", home, languages=True)
    examples = generator.examples
    configs = (examples / "consert_a_config.yml", examples / "consert_b_config.yml")
    generator.generate(workspace.path, examples / "two_conserts.xml", *configs)
    return workspace


@pytest.fixture(scope="module")
def joined(generator, folder, home):
    """The two steps of D7.2 4.2.5: the workspace, what was there before system B, and after."""
    workspace = Workspace(folder / "edited", home, languages=True)
    examples = generator.examples
    model = examples / "two_conserts.xml"
    config_a = folder / "consert_a_config.yml"
    config_a.write_text(models.config_of_d72((examples / "consert_a_config.yml").read_text()))
    generator.generate(workspace.path, model, config_a)
    before = workspace.contents()
    generator.generate(workspace.path, model, examples / "consert_b_config.yml")
    return workspace, before, workspace.contents()


@pytest.fixture(scope="module")
def edited(joined):
    """The workspace with the hand edits, in git."""
    workspace = joined[0]
    edits.edit_system_a(workspace.eddi_input("conserta"))
    edits.edit_system_b(workspace.eddi_input("consertb"))
    git(workspace.path, "init", "--quiet")
    git(workspace.path, "add", "--all")
    git(workspace.path, "commit", "--quiet", "--message", "Generated, with hand edits")
    return workspace


@pytest.fixture(scope="module")
def built(shipped, edited):
    """What both builders said, side by side on two cores: catkin build, catkin_make."""
    with ThreadPoolExecutor() as pool:
        builds = [pool.submit(shipped.catkin_build), pool.submit(edited.catkin_make)]
        return [build.result() for build in builds]


@pytest.fixture(scope="module")
def updated(generator, edited, built, folder):
    """Model and template have changed, `copier update` has run, the workspace is rebuilt."""
    examples = generator.examples
    model, config = folder / "two_conserts.xml", folder / "consert_b_config.yml"
    model.write_text(models.second_model((examples / model.name).read_text()))
    config.write_text(models.second_config((examples / config.name).read_text()))
    generator.run("answers", "-m", model, "-c", config, "-o", folder / "answers.yml")
    generator.release_second_version()
    generator.update(edited.packages / "conserta")
    git(edited.path, "commit", "--quiet", "--all", "--message", "Update system A")
    generator.update(edited.packages / "consertb", folder / "answers.yml")
    edited.catkin_make("install")
    return edited


@pytest.fixture(scope="module")
def roscore(folder):
    core = Roscore(folder / "ros").start()
    yield core
    core.stop()


@pytest.fixture
def launched(roscore, tmp_path):
    """Return a function that launches the monitors of an environment."""
    return lambda env, name="run": Run(roscore, env, tmp_path / name)
