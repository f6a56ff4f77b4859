"""Where templates come from, what is reported when they cannot be had, and where they render."""

import tempfile
from pathlib import Path

import pytest

from eddi_scaffold.common.problems import EddiError
from eddi_scaffold.packages import rendering, unpacking
from eddi_scaffold.packages.rendering import Renderer, Template, own_template
from eddi_scaffold.packages.unpacking import Unpacked, unpacked
from tests.diagnosed import assert_reported


def code_of(failure: pytest.ExceptionInfo[EddiError]) -> str:
    (problem,) = failure.value.problems
    return problem.code


@pytest.fixture
def installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return the package folder of an installation with neither a checkout nor a bundle."""
    package = tmp_path / "site-packages" / "eddi_scaffold"
    package.mkdir(parents=True)
    monkeypatch.setattr(rendering, "__file__", str(package / "packages" / "rendering.py"))
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.delenv("XDG_DATA_HOME", raising=False)
    return package


def test_no_templates_is_t001(installed: Path) -> None:
    with pytest.raises(EddiError) as failure:
        own_template()
    assert_reported("T001", failure.value.problems)


def test_the_bundle_is_put_where_a_later_update_finds_it(installed: Path, tmp_path: Path) -> None:
    (installed / "templates.bundle").write_bytes(b"bundle")
    template = own_template()
    assert template.location == "~/.local/share/eddi-scaffold/templates.bundle"
    assert not (tmp_path / "home").exists(), "who only looks changes nothing"
    template.keep()
    put = tmp_path / "home" / template.location[2:]
    assert put.read_bytes() == b"bundle"
    assert own_template() == template
    put.with_name("templates.version").write_text("900.0.0")
    (installed / "templates.bundle").write_bytes(b"older")
    template.keep()
    assert put.read_bytes() == b"bundle", "that of a newer release stays"
    assert not [path for path in put.parent.iterdir() if "template" not in path.name]


def test_a_bundle_that_can_be_put_nowhere_is_t002(
    installed: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (installed / "templates.bundle").write_bytes(b"bundle")
    (tmp_path / "file").touch()
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "file"))
    with pytest.raises(EddiError) as failure:
        own_template().keep()
    (problem,) = failure.value.problems
    assert_reported("T001", [problem])


def test_no_git_is_t003(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(EddiError) as failure, unpacked(tmp_path, "HEAD"):
        pass
    assert_reported("T001", failure.value.problems)


def test_what_git_refuses_is_t004(tmp_path: Path) -> None:
    with pytest.raises(EddiError) as failure, unpacked(tmp_path, "v9"):
        pass
    assert code_of(failure) == "T004"
    assert "not a git repository" in str(failure.value)


def test_what_copier_refuses_is_t004(tmp_path: Path) -> None:
    source = tmp_path / "template"
    source.mkdir()
    (source / "copier.yml").write_text(
        "word: {type: str, validator: '{% if true %}no{% endif %}'}\n"
    )
    unpacked_here = Unpacked(None, True, lambda: source)
    renderer = Renderer(Template(str(source), None), unpacked_here)
    with pytest.raises(EddiError) as failure:
        renderer.render({"word": "x"}, tmp_path / "out")
    assert_reported("T004", failure.value.problems)


def test_it_renders_in_memory_or_where_the_user_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory
) -> None:
    for name in ("TMPDIR", "TEMP", "TMP"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(unpacking, "_MEMORY", tmp_path)
    monkeypatch.setattr(unpacking, "_ENOUGH", 0)
    with unpacking.scratch_folder("eddi-") as folder:
        assert Path(folder).parent == tmp_path
        assert Path(folder).stat().st_mode & 0o777 == 0o700
    other = tmp_path_factory.mktemp("other")
    monkeypatch.setattr(tempfile, "tempdir", str(other))
    monkeypatch.setattr(unpacking, "_ENOUGH", 2**80)  # memory is short
    with unpacking.scratch_folder("eddi-") as folder:
        assert Path(folder).parent == other
    monkeypatch.setattr(unpacking, "_ENOUGH", 0)
    monkeypatch.setenv("TMPDIR", str(other))
    with unpacking.scratch_folder("eddi-") as folder:
        assert Path(folder).parent == other
    assert not list(tmp_path.iterdir())
