"""Compiled SafeML monitors: the text, its tables, and what is refused."""

from __future__ import annotations

import ast
import hashlib
import subprocess
import sys

import numpy as np
import pytest
from eddi_runtime import ModelError as RefusedAtStart

from eddi_scaffold.compiling.compilation import compile_model
from eddi_scaffold.compiling.document import ModelError, check_document, digest_of
from eddi_scaffold.compiling.execution import build
from runtime_lib.tests.safeml.monitors import document, step
from tests.compiling.formatting import objections

ROWS = [[k / 10] for k in range(10)]
WIDE = np.random.RandomState(1).normal(size=(60, 5)).tolist()
PCA = {"components": 2, "residual_test": True, "halves": True}
CASES = [
    document(ROWS),
    document(WIDE, metric="ad", **PCA, settings={"max_age": 1.5}),
    document(np.random.RandomState(2).normal(size=(9, 30)).tolist(), metric="cvm"),
    document(ROWS, stride=3, settings={"array_backend": "torch", "on_omission": "clear"}),
]
HOSTILE = '"""\nimport os\n__import__("os")'


def signed(made):
    return dict(made, sha256=digest_of(made))


def filed(made):
    """Return a document whose reference lies in a file, and the file."""
    numbers = np.array(made["model"]["sample"])
    data = numbers.astype("<f8").tobytes()
    digest = hashlib.sha256(data).hexdigest()
    made["model"]["sample"] = {"file": "r.bin", "sha256": digest, "shape": list(numbers.shape)}
    return signed(made), {"r.bin": data}


@pytest.mark.parametrize("made", CASES)
def test_the_formatter_changes_nothing(made):
    assert objections(compile_model(check_document(made))) == ""


@pytest.mark.parametrize("made", CASES)
def test_the_text_is_for_python_3_8(made):
    ast.parse(compile_model(check_document(made)), feature_version=(3, 8))


def test_nothing_of_a_hostile_model_becomes_code():
    made = document(ROWS)
    made["model"]["reference"]["name"] = HOSTILE
    made["inputs"] = [dict(made["inputs"][0], id=HOSTILE, attribute="a b", accepts=[HOSTILE])]
    made = signed(dict(made, id=HOSTILE, source={"file": HOSTILE}))
    text = compile_model(check_document(made))
    assert text.isascii()
    names = {node.id for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Name)}
    assert "__import__" not in names
    assert build(check_document(made)).inputs[0].id == HOSTILE


def test_the_digits_of_a_table_are_kept():
    made = document(WIDE, **PCA)
    one = build(check_document(made))
    assert one.reference == tuple(map(tuple, made["model"]["sample"]))
    assert one.axes.vectors.tolist() == made["model"]["axes"]["table"][2:]


def test_it_is_compiled_without_numpy():
    """Copier's Python may have none."""
    program = (
        "import sys; sys.modules['numpy'] = None; import json; "
        "from eddi_scaffold.compiling.compilation import compile_model; "
        "from eddi_scaffold.compiling.document import check_document; "
        "print(compile_model(check_document(json.load(sys.stdin))), end='')"
    )
    import json

    for made in CASES:
        done = subprocess.run(
            [sys.executable, "-c", program],
            input=json.dumps(made),
            capture_output=True,
            text=True,
            check=True,
        )
        assert done.stdout == compile_model(check_document(made))


def test_two_monitors_of_one_text_are_independent():
    first = build(check_document(CASES[1]))
    other = type(first)()
    step(first, WIDE[0])
    assert (first.status_message()[1]["filled"], other.status_message()[1]["filled"]) == (1, 0)


def test_a_reference_in_a_file_is_the_same(tmp_path, monkeypatch):
    made, files = filed(document(WIDE, metric="ad", **PCA))
    (tmp_path / "filed_scope.py").write_text(compile_model(check_document(made)))
    (tmp_path / "r.bin").write_bytes(files["r.bin"])
    monkeypatch.syspath_prepend(tmp_path)
    of_file = __import__("filed_scope").Monitor()
    in_memory, of_text = build(check_document(made, "m", files)), build(check_document(CASES[1]))
    for row in WIDE:
        results = [step(one, row) for one in (of_file, in_memory, of_text)]
    assert results[0] == results[1] == results[2]
    assert not results[0].omission


def test_a_file_that_is_absent_or_another_one_is_refused_at_the_start(tmp_path, monkeypatch):
    made, _ = filed(document(WIDE))
    (tmp_path / "lone_scope.py").write_text(compile_model(check_document(made)))
    monkeypatch.syspath_prepend(tmp_path)
    monitor_class = __import__("lone_scope").Monitor
    with pytest.raises(RefusedAtStart, match=r"r\.bin: cannot read the file: No such .* again"):
        monitor_class()
    (tmp_path / "r.bin").write_bytes(b"changed")
    with pytest.raises(RefusedAtStart, match=r"r\.bin: the file changed since generation: run"):
        monitor_class()


TABLE = {"file": "r.bin", "sha256": "0", "shape": [1, 10]}


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"metric": "Wasserstein"}, "the metric 'Wasserstein' is not known"),
        ({"window_size": 0}, "'window_size' of the model is below 1"),
        ({"stride": True}, "'stride' of the model has the wrong type bool"),
        ({"threshold_scaled": 0.5}, "'threshold_scaled' of the model has the wrong type float"),
        ({"settings": {"max_age": -1}}, "'max_age' is not a number of seconds above 0"),
        ({"settings": {"on_omission": "x"}}, "'on_omission' is 'x', not one of hold, clear"),
        ({"sample": [[1.0], [2.0, 3.0]]}, "the rows differ in length"),
        ({"sample": [["x"]]}, "'sample' of the model holds what is no number"),
        ({"sample": [[True]]}, "'sample' of the model holds what is no number"),
        ({"sample": [[]]}, "'sample' of the model is not a list of rows"),
        ({"sample": [[1.0], [2.0]]}, "has 2 features, the model other ones"),
        ({"sample": dict(TABLE, shape=[1, 0])}, "'shape' of 'sample' of the model is not a pair"),
        ({"sample": dict(TABLE, file="../r")}, "'../r' is not the name of a file beside the code"),
        ({"axes": {"table": [[0.0], [1.0]]}}, "'axes' are none of 10 features"),
        ({"axes": {"table": [[0.0]] * 3, "residual_floor": "x"}}, "'residual_floor' of 'axes'"),
    ],
)
def test_damaged_models_are_refused(change, reason):
    made = document(ROWS, settings=change.get("settings", {}))
    made["model"].update({k: v for k, v in change.items() if k != "settings"})
    if "axes" in change:
        made["model"]["reference"]["features"] = 10
    with pytest.raises(ModelError, match=reason):
        build(check_document(signed(made), "model.json"))


def test_a_model_of_an_older_generator_is_refused():
    made = document(ROWS)
    del made["model"]["axes"]
    with pytest.raises(
        ModelError, match=r"older eddi-scaffold made it: give `eddi-scaffold upgrade`"
    ):
        compile_model(check_document(signed(made)))


def test_two_inputs_are_refused():
    made = document(ROWS)
    made["inputs"].append({"id": "b", "attribute": "b", "requires": []})
    with pytest.raises(ModelError, match="one input is expected, not 2"):
        build(check_document(signed(made), "model.json"))
