"""Vectors of ConSerts: those of an independent program, and every mutant is killed or equal."""

from __future__ import annotations

import ast
import itertools
import json
import random
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import yaml
from eddi_runtime.history import EDDIInputBase
from eddi_runtime.testing import failures
from hypothesis import settings

from eddi_scaffold.common.files import Source
from eddi_scaffold.kinds.consert.read_short import read_consert
from eddi_scaffold.kinds.consert.vectors import ConSertVectors
from eddi_scaffold.monitors.answers import VECTORS, files_of
from eddi_scaffold.packages.assembly import monitors_of
from tests.data_files import tabled

ROOT = Path(__file__).parents[3]
DATA = ROOT / "tests" / "data" / "evidence" / "conserts.yml"
CASES = {case["id"]: case for case in yaml.safe_load(DATA.read_text("utf-8"))}


@pytest.mark.parametrize("name", CASES)
def test_vectors_are_those_of_the_definition(name: str) -> None:
    case = CASES[name]
    consert, _ = read_consert(Source(f"{name}.yml", json.dumps(case["model"]).encode()))
    assert consert is not None
    vectors = ConSertVectors(consert)
    ids = [guarantee.id for guarantee in consert.guarantees]
    assert list(consert.leaves) == case["want"]["leaves"]
    for id_, expected in case["want"]["guarantees"].items():
        got = defaultdict[str, set[str]](set)
        for class_, leaves in vectors.of(id_):
            verdict = vectors.verdicts(leaves)[ids.index(id_)]
            got[class_].add(f"{vectors.letters(leaves)} {verdict}")
        for class_ in ("path", "path_rest_unknown", "cut", "cut_rest_unknown", "mcdc", "unknown"):
            assert got[class_] == set(expected[class_]), class_
        assert [sorted(path) for path in vectors.paths[id_] or ()] == expected["paths"]
        assert [sorted(cut) for cut in vectors.cuts[id_] or ()] == expected["cuts"]


def mutants(text: str) -> Iterator[str]:
    """Yield each text in which a single node is another one."""
    for number in range(sum(1 for _ in ast.walk(ast.parse(text)))):
        for k in itertools.count():
            tree = ast.parse(text)
            node = next(itertools.islice(ast.walk(tree), number, None))
            if not changed(node, k):
                break
            yield ast.unparse(tree)


def changed(node: Any, k: int) -> bool:
    """Change a node in the k-th way; ``False`` where there is none."""
    if isinstance(node, ast.Constant):
        value = node.value
        ways: list[Any] = []
        if isinstance(value, bool) or value is None:
            ways = [not value]
        elif isinstance(value, int | float):
            ways = [value + 1, value - 1, value * 1.001]
        elif isinstance(value, str):
            ways = [f"{value}x"]
        if k < len(ways):
            node.value = ways[k]
        return k < len(ways)
    if isinstance(node, ast.Compare):
        kinds = (ast.Lt, ast.LtE, ast.Gt, ast.Eq, ast.NotEq, ast.Is, ast.IsNot)
        others = [of for of in kinds if not isinstance(node.ops[0], of)]
        if k < len(others):
            node.ops[0] = others[k]()
        return k < len(others)
    if isinstance(node, ast.IfExp) and k < 2:
        node.test = ast.Constant(bool(k))
        return True
    if isinstance(node, ast.Tuple) and isinstance(node.ctx, ast.Load) and len(node.elts) > 1:
        if k < len(node.elts):
            del node.elts[k]
        elif k < 2 * len(node.elts) - 1:
            at = k - len(node.elts)
            node.elts[at : at + 2] = node.elts[at : at + 2][::-1]
        else:
            return False
        return True
    if isinstance(node, ast.Call) and k < len(node.keywords):
        del node.keywords[k]
        return True
    return False


PROVED = 20  # of the survivors of a package in the quick profile
RAW = (True, False, None, 1, float("nan"), "True")


def observed(monitor_class: Any) -> list[object]:
    """Return all that a monitor shows, for all that its inputs can be."""
    names = [spec.attribute for spec in monitor_class.inputs]
    rows: list[object] = []
    for values in itertools.product(RAW, repeat=len(names)):
        monitor = monitor_class()
        output = monitor.execute_step(SimpleNamespace(**dict(zip(names, values, strict=True))), 0)
        rows += [repr(output), monitor.verdicts(), monitor.input_verdicts()]
        rows += [monitor.explain(), monitor.best_guarantees(), monitor.faults()]
    return rows


def input_class(of: Any) -> type[Any]:
    """Return an ``EDDIInput`` as a package has it."""

    class Input(EDDIInputBase):
        def __init__(self) -> None:
            for spec in of.inputs:
                setattr(self, spec.attribute, spec.default)
            super().__init__(of.inputs)

        def processing(self, messages: Any) -> None:
            self.begin_processing()
            for spec in of.inputs:
                method = getattr(self, f"process_{spec.attribute}")
                update = self.update_expression if spec.expression else self.update
                update(spec.id, method, messages, spec.requires)

    return Input


class Package:
    """A package of an example, whose text can be changed."""

    def __init__(self, id_: str, model: str | None, config: str, folder: Path) -> None:
        examples = ROOT / "examples"
        monitors, _ = monitors_of(examples / model if model else None, [examples / config])
        files = files_of(next(monitor for monitor in monitors if monitor.id == id_))
        self.vectors = folder / "vectors.json"
        self.vectors.write_bytes(files[VECTORS])
        text = files["compiled.py"].decode()
        self.head, _, body = text.partition("\n# sha256 of the lines below")
        self.body = body.partition("\n")[2]

    def class_of(self, text: str) -> Any:
        scope: dict[str, Any] = {"__name__": "compiled", "__file__": "no file"}
        exec(f"{self.head}\n{text}", scope)
        return scope["Monitor"]

    def killed(self, text: str) -> bool:
        try:
            class_ = self.class_of(text)
            return bool(failures(str(self.vectors), class_, input_class(class_)))
        except Exception:  # noqa: BLE001 - a mutant that cannot run is seen
            return True

    def survivors(self) -> tuple[list[str], int]:
        """Return changed texts that the vectors do not tell apart, and how many they do."""
        assert not self.killed(self.body)
        same = ast.unparse(ast.parse(self.body))
        texts = [text for text in mutants(self.body) if text != same]
        survivors = [text for text in texts if not self.killed(text)]
        return survivors, len(texts) - len(survivors)


def names_only(text: str, class_: Any, original: Any) -> bool:
    """Return whether a mutant is the same but for the name of its model."""
    names = (original.model_id, original.digest)
    return (class_.model_id, class_.digest) != names and "model_id" in text


@pytest.mark.filterwarnings("ignore::SyntaxWarning")
@tabled
def test_each_mutant_is_killed_or_proved_equal_by_exhaustion(
    id_: str, model: str | None, config: str, least: int, tmp_path: Path
) -> None:
    package = Package(id_, model, config, tmp_path)
    survivors, killed = package.survivors()
    assert killed >= least
    if settings.default.max_examples <= 1000 and len(survivors) > PROVED:
        survivors = random.Random(1).sample(survivors, PROVED)  # the long profile proves all
    original = package.class_of(package.body)
    expected = observed(original)
    for text in survivors:
        mutant = package.class_of(text)
        assert names_only(text, mutant, original) or observed(mutant) == expected, text
