"""Compiled ConSerts: the text, what of a hostile model is in it, and a changed file."""

import ast

import pytest
from eddi_runtime import ModelError

from runtime_lib.tests.conserts import categorical, consert, give, numeric
from tests.program.formatting import objections

HOSTILE = [
    '"""',
    "\\",
    "\n",
    "__import__('os')",
    "a b",
    "class",
    "self",
    "é",
    "\ud800",
    "x" * 500,
    "#",
]


def large(**settings):
    ids = [f"input_{k}" for k in range(40)]
    gates = [f"gate{k}{'&|'[k % 2]}" for k in range(30)]
    edges = [f"{one}>gate{k % 30}" for k, one in enumerate(ids)]
    edges += [f"gate{k}>gate{k + 1}" for k in range(29)]
    evidence = [
        (one, [numeric("[0, 5)", "[7, inf]"), categorical("low", "mid"), numeric("[1, 2]")][k % 3])
        for k, one in enumerate(ids)
    ]
    guarantees = [{"id": "G", "ranking": 1}, "H", {"id": "D", "default": True}]
    edges += ["gate29>G", "gate7>H", "gate8>H"]
    return consert(evidence, [], gates, guarantees, edges, [("S", ["G", "H"])], **settings)


def hostile():
    evidence = [(one, categorical(*HOSTILE)) for one in HOSTILE]
    edges = [(one, "G") for one in HOSTILE]
    specs = {one: {"attribute": f"value {k}"} for k, one in enumerate(HOSTILE)}
    paths = {one: HOSTILE[-k] for k, one in enumerate(HOSTILE)}
    name = '"""\nimport os \\'
    return consert(evidence, (), (), ["G"], edges, specs=specs, paths=paths, name=name)


@pytest.mark.parametrize("made", [large(), large(filtered=("debounce", 3))])
def test_the_formatter_changes_nothing(made):
    assert objections(made.text()) == ""
    ast.parse(made.text(), feature_version=(3, 8))


def test_nothing_of_a_hostile_model_becomes_code():
    text = hostile().text()
    assert text.isascii()
    names = {node.id for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Name)}
    assert "__import__" not in names
    monitor = hostile().monitor()
    good = {f"value {k}": one for k, one in enumerate(HOSTILE)}
    assert monitor.execute_step(give(**good)) == [{"id": "G", "active": True}]
    bad = dict(good, **{"value 3": "else"})
    assert monitor.execute_step(give(**bad)) == [{"id": "G", "active": False}]


def test_a_changed_file_is_refused(tmp_path, monkeypatch):
    text = large().text()
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "compiled_whole.py").write_text(text)
    __import__("compiled_whole")
    for number, changed in enumerate(
        (text[: text.rindex("        return [")], text.replace("== 2", "== 1", 1))
    ):
        (tmp_path / f"compiled_{number}.py").write_text(changed)
        with pytest.raises(ModelError, match=r"the file was changed .*eddi-scaffold upgrade"):
            __import__(f"compiled_{number}")


def test_another_format_of_a_part_is_refused():
    text = large().text().replace("consert: 3}", "consert: 7}")
    with pytest.raises(ModelError, match=r"format 7 of eddi_runtime\.consert, but .* runs 3: run"):
        exec(text, {"__file__": "compiled.py"})
