"""Compiled SafeML monitors: the text and its tables."""

import ast

import numpy as np
import pytest
from eddi_runtime import ModelError

from eddi_scaffold.kinds.safeml.compile import compile_safeml
from runtime_lib.tests.safeml.monitors import scope, step
from tests.program.formatting import objections

ROWS = [[k / 10] for k in range(10)]
WIDE = np.random.RandomState(1).normal(size=(60, 5)).tolist()
PCA = {"components": 2, "residual": True, "halves": True}
CASES = [
    scope(ROWS),
    scope(WIDE, metric="ad", spec=PCA, max_age=1.5),
    scope(np.random.RandomState(2).normal(size=(9, 30)).tolist(), metric="cvm"),
    scope(ROWS, stride=3, array_backend="torch", on_omission="clear"),
]
HOSTILE = '"""\nimport os\n__import__("os")'


@pytest.mark.parametrize("made", CASES)
def test_the_formatter_changes_nothing(made):
    assert objections(made.text()) == ""
    ast.parse(made.text(), feature_version=(3, 8))


def test_nothing_of_a_hostile_model_becomes_code():
    keys = {"id": HOSTILE, "attribute": "a b", "accepts": [HOSTILE]}
    made = scope(ROWS, name=HOSTILE, reference=HOSTILE, input_keys=keys)
    text = made.text()
    assert text.isascii()
    names = {node.id for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Name)}
    assert "__import__" not in names
    assert made.monitor().inputs[0].id == HOSTILE


def test_a_reference_in_a_file_is_the_same(tmp_path, monkeypatch):
    made = scope(WIDE, metric="ad", spec=PCA)
    in_text = made.monitor()
    monkeypatch.setattr(f"{compile_safeml.__module__}.MOST_IN_TEXT", 20)
    (tmp_path / "filed_scope.py").write_text(made.text())
    files = made.compiled().tables
    assert "reference.bin" in files
    for name, data in files.items():
        (tmp_path / name).write_bytes(data)
    monkeypatch.syspath_prepend(tmp_path)
    of_file, in_memory = __import__("filed_scope").Monitor(), made.monitor()
    for row in WIDE:
        results = [step(one, row) for one in (of_file, in_memory, in_text)]
        assert results[0] == results[1] == results[2]
    assert not results[0].omission


def test_a_file_that_is_absent_or_another_one_is_refused_at_the_start(tmp_path, monkeypatch):
    monkeypatch.setattr(f"{compile_safeml.__module__}.MOST_IN_TEXT", 20)
    (tmp_path / "lone_scope.py").write_text(scope(WIDE).text())
    monkeypatch.syspath_prepend(tmp_path)
    monitor_class = __import__("lone_scope").Monitor
    with pytest.raises(ModelError, match=r"reference\.bin: cannot read the file: No such .* again"):
        monitor_class()
    (tmp_path / "reference.bin").write_bytes(b"changed")
    with pytest.raises(ModelError, match=r"reference\.bin: the file changed since generation: run"):
        monitor_class()
