"""A table that stands beside a test file is run by the test of its name."""

from __future__ import annotations

import re

import yaml

from tests.checkouts import HERE


def test_no_table_is_without_its_test() -> None:
    files = [path for path in HERE.glob("tests/**/test_*.yml") if "golden" not in path.parts]
    assert files
    for file in files:
        tables = yaml.load(file.read_text("utf-8"), yaml.CSafeLoader)
        text = file.with_suffix(".py").read_text("utf-8")
        assert [*tables] == re.findall(r"@tabled\n(?:@.*\n)*def test_(\w+)", text), file
