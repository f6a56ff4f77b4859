"""What people write in a configuration gives the same package as the spelling of D7.2."""

import re
from pathlib import Path

import pytest
import yaml

from tests.cli.command import run

DATA = Path(__file__).parents[1] / "data" / "users"
SPELLINGS = yaml.load((DATA / "spellings.yml").read_text("utf-8"), yaml.CSafeLoader)["cases"]


def generated(case, spelling, folder):
    """Write a case, generate it, and return path -> content of its packages."""
    folder.mkdir()
    files = {**case["files"], **case[spelling]}
    for name, text in files.items():
        (folder / name).write_text(text, "utf-8")
    configs = [name for name in case[spelling] if "Model:" in files[name]]
    into = ("--platform", "plain", "-o", "out")
    if case["platform"] == "ros1":
        (folder / "ws" / "src").mkdir(parents=True)
        into = ("-w", "ws")
    done = run("generate", *into, *(w for c in configs for w in ("-c", c)), cwd=folder)
    assert done.status == 0, done.err
    out = folder / into[-1]
    texts = {path.relative_to(out): path.read_bytes() for path in out.rglob("*") if path.is_file()}
    if case.get("equal") == "but digests":
        texts = {name: re.sub(rb"\b[0-9a-f]{16,64}\b", b"", data) for name, data in texts.items()}
    return texts


@pytest.mark.slow
@pytest.mark.parametrize("case", SPELLINGS, ids=lambda case: case["id"])
def test_both_spellings_give_one_package(case, tmp_path):
    old = generated(case, "old", tmp_path / "old")
    new = generated(case, "new", tmp_path / "new")
    assert sorted(old) == sorted(new)
    assert [str(name) for name in old if old[name] != new[name]] == []
