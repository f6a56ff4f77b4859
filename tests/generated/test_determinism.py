"""The same input gives the same bytes, whoever generates, where and when, at once or in steps."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from tests.checkouts import tree, without_origin
from tests.cli.command import EXAMPLE, run, scaffold
from tests.generated.conftest import generate

pytestmark = pytest.mark.slow

AUCKLAND = {
    "LC_ALL": "tr_TR.UTF-8",  # upper and lower case of i differ, if the locale is installed
    "LANG": "tr_TR.UTF-8",
    "TZ": "Pacific/Auckland",
    "PYTHONHASHSEED": "4711",
    "COLUMNS": "40",
    "PYTHONUTF8": "0",
    "EDDI_TESTS_COMPILED": "",  # rendered anew; see tests/quick_copier.py
}


def test_environment_and_order_do_not_matter(both: Path, tmp_path: Path) -> None:
    """Locale, time zone, hash seed, working directory, umask, order of the configurations."""
    other = tmp_path / "other one, with ümlauts"
    (other / "src").mkdir(parents=True)
    (tmp_path / "model").symlink_to(EXAMPLE)
    configs = [word for letter in "ba" for word in ("-c", f"../model/consert_{letter}_config.yml")]
    words = ("generate", "-w", ".", "-m", "../model/two_conserts.xml", *configs)
    process = scaffold(*words, cwd=other, env=AUCKLAND, umask=0o077)
    assert process.communicate()[1]
    assert process.returncode == 0
    assert without_places(tree(other / "src" / "eddi_monitor")) == without_places(tree(both))


def without_places(files: dict[str, tuple[bool, bytes]]) -> dict[str, tuple[bool, bytes]]:
    """Leave out where the templates lay, and the digests that know it."""
    return {
        name: (executable, without_origin(data))
        for name, (executable, data) in files.items()
        if not name.endswith(".eddi/manifest")
    }


def test_no_trace_of_the_machine(both: Path) -> None:
    """No date, absolute path, host or user name in what is generated."""
    host = subprocess.run(
        ["uname", "-n"], capture_output=True, text=True, check=True
    ).stdout.strip()
    for name, (_, data) in tree(both).items():
        text = data.decode()
        if name.endswith(".copier-answers.yml"):
            text = without_origin(data).decode()
        assert str(both.parents[3]) not in text, name
        assert str(Path.home()) not in text or str(Path.home()) == "/", name
        assert len(host) < 6 or host not in text, name


def test_one_after_the_other_is_both_at_once(both: Path, tmp_path: Path) -> None:
    first = tree(generate(tmp_path, "a"))
    joined = tree(generate(tmp_path, "b"))
    assert joined == tree(both)
    changed = {name for name, file in first.items() if joined[name] != file}
    assert {name.partition("/")[0] for name in changed} == {"eddi_monitor", "eddi_monitor_launcher"}
    model = ("-m", EXAMPLE / "two_conserts.xml")
    assert run("upgrade", "-w", tmp_path, *model, cwd=tmp_path).status == 0
    assert tree(tmp_path / "src" / "eddi_monitor") == joined, "an upgrade changes nothing"
