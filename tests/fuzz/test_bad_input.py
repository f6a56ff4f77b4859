"""Damaged models and configurations: always an answer, never a traceback, never a changed file.

``pytest tests/fuzz --hypothesis-profile=long`` does thousands of mutations of each file.
"""

import json
from functools import partial
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from eddi_scaffold.common.problems import EddiError
from eddi_scaffold.packages.assembly import assemble, monitors_of
from eddi_scaffold.platforms import platforms
from tests.cli.command import EXAMPLE, Result, files_below, run
from tests.fuzz.damage import damaged
from tests.kinds.consert.example import ROVER

pytestmark = pytest.mark.slow

XML = (EXAMPLE / "two_conserts.xml").read_bytes()
CONFIG = (EXAMPLE / "consert_a_config.yml").read_bytes()
FEW = max(10, settings.default.max_examples // 50)
"""Examples of the tests that render packages or start processes."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with the example, ConSertA as YAML and one generated package."""
    place = tmp_path_factory.mktemp("fuzz")
    assert run("example", "two-conserts", ".", cwd=place).status == 0
    assert run("export", "two_conserts.xml", "-o", ".", cwd=place).status == 0
    made = run(*GENERATE, "ConSertA.yml", "-c", "consert_a_config.yml", cwd=place)
    assert made.status == 0, made.err
    return place


GENERATE = ("generate", "--platform", "plain", "-o", "packages", "-m")
YAML = ROVER.encode()


def mutations(data: bytes) -> st.SearchStrategy[bytes]:
    """Return the bytes with some damage, which shrinks."""
    return st.randoms().map(partial(damaged, data))


def answered(result: Result, *statuses: int) -> None:
    assert result.status in statuses, result.err
    assert "Traceback" not in result.err
    assert "this is a bug" not in result.err


def refused(folder: Path, model: str, config: str | None, platform: str) -> bool:
    """Do all that `generate` does before it renders; tell whether it refuses the files."""
    configs = [folder / config] if config else []
    try:
        monitors, problems = monitors_of(folder / model, configs)
        assemble(monitors, platforms()[platform], folder / "elsewhere", problems)
    except EddiError:
        return True
    return False


SOUND = {"two_conserts.xml": XML, "ConSertA.yml": YAML, "consert_a_config.yml": CONFIG}


@given(st.sampled_from(list(SOUND)).flatmap(lambda n: st.tuples(st.just(n), mutations(SOUND[n]))))
def test_check_refuses_what_generate_refuses(folder: Path, one: tuple[str, bytes]) -> None:
    name = f"damaged-{one[0]}"
    (folder / name).write_bytes(one[1])
    is_config = "config" in name
    model, config = ("two_conserts.xml", name) if is_config else (name, None)
    is_refused = refused(folder, model, config, "ros1" if is_config else "plain")
    words = (model, config) if is_config else (model, "--platform", "plain")
    answered(run("check", *words, cwd=folder), *([1] if is_refused else [0, 1]))


@given(data=mutations(XML), config=st.one_of(st.just(CONFIG), mutations(CONFIG)))
def test_a_failure_is_one_json_object(folder: Path, data: bytes, config: bytes) -> None:
    (folder / "damaged.xml").write_bytes(data)
    (folder / "damaged_config.yml").write_bytes(config)
    for command in (["check", "damaged_config.yml"], ["show"], ["compose"]):
        result = run(*command, "damaged.xml", "--json", cwd=folder)
        answered(result, 0, 1, 2)
        found = json.loads(result.out)
        if result.status == 2:
            assert list(found) == ["problems"]
            assert any(problem["level"] == "error" for problem in found["problems"])


@settings(max_examples=FEW)
@given(
    model=st.one_of(mutations(YAML), st.just(YAML)),
    config=st.one_of(st.none(), mutations(CONFIG)),
)
def test_a_refused_generation_changes_no_file(
    folder: Path, model: bytes, config: bytes | None
) -> None:
    (folder / "damaged_model.yml").write_bytes(model)
    (folder / "damaged_config.yml").write_bytes(config or CONFIG)
    files = ("two_conserts.xml", "-c", "damaged_config.yml") if config else ("damaged_model.yml",)
    before = files_below(folder)
    result = run(*GENERATE, *files, cwd=folder)
    answered(result, 0, 2, 3)
    if result.status == 2:
        assert files_below(folder) == before


@settings(max_examples=FEW)
@given(data=st.data())
def test_damaged_packages_change_no_file(folder: Path, data: st.DataObject) -> None:
    """A merge or a slip of the hand damages a package: what is refused is left as it is."""
    package = folder / "packages" / "conserta"
    assert run(*GENERATE, "ConSertA.yml", "-c", "consert_a_config.yml", cwd=folder).status != 2
    name = data.draw(
        st.sampled_from([".copier-answers.yml", "EDDIInput.py", "config/ConSertA.yml"])
    )
    path = next(path for path in (package / name, package / Path(name).name) if path.exists())
    sound = path.read_bytes()
    path.write_bytes(data.draw(mutations(sound)))
    before = files_below(package)
    try:
        answered(run("status", package, cwd=folder), 0, 1, 2)
        answered(run("regions", package, cwd=folder), 0, 2)
        assert files_below(package) == before
        result = run("upgrade", package, cwd=folder)
        answered(result, 0, 2, 3)
        if result.status == 2:
            assert files_below(package) == before
    finally:
        path.write_bytes(sound)
