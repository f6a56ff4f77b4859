"""The same input gives the same bytes, whoever generates, where and when."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from tests.checkouts import Checkout, tree, without_origin
from tests.generated.conftest import generate

pytestmark = pytest.mark.slow

AUCKLAND = {
    "LC_ALL": "tr_TR.UTF-8",  # upper and lower case of i differ, if the locale is installed
    "LANG": "tr_TR.UTF-8",
    "TZ": "Pacific/Auckland",
    "PYTHONHASHSEED": "4711",
    "COLUMNS": "40",
}
PLAIN = {"LC_ALL": "C", "TZ": "America/Los_Angeles", "PYTHONHASHSEED": "1", "PYTHONUTF8": "0"}


def test_environment_and_order_do_not_matter(clone: Checkout, tmp_path: Path) -> None:
    """Locale, time zone, hash seed, working directory, umask, order of the configurations."""
    one, other = tmp_path / "one", tmp_path / "other one, with ümlauts"
    one.mkdir()
    other.mkdir()
    got_one = tree(generate(Checkout(clone.path, AUCKLAND), one, "a", "b"))
    (tmp_path / "model").symlink_to(clone.example)
    (other / "src").mkdir()
    configs = [word for letter in "ba" for word in ("-c", f"../model/consert_{letter}_config.yml")]
    words = ("-q", "generate", "-w", ".", "-m", "../model/two_conserts.xml", *configs)
    Checkout(clone.path, PLAIN).eddi(*words, cwd=other, umask=0o077)
    assert tree(other / "src" / "eddi_monitor") == got_one


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
