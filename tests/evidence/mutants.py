"""Single mutants of a compiled monitor, and which of them its vectors do not kill."""

from __future__ import annotations

import ast
import copy
import itertools
from collections.abc import Callable, Iterator
from difflib import ndiff
from importlib.util import spec_from_file_location
from pathlib import Path
from random import Random
from typing import Any

import pytest
from eddi_runtime.testing import failures

from eddi_scaffold.monitors.answers import VECTORS, files_of
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.packages.verifying import input_class


def mutants(text: str, is_tried: Callable[[int], bool] = lambda _: True) -> Iterator[str]:
    """Yield each text in which a single node is another one, or those of some numbers."""
    nodes, total = [*ast.walk(ast.parse(text))], itertools.count()
    for number, node in enumerate(nodes):
        for k in itertools.count():
            probe = copy.copy(node)
            for name, value in ast.iter_fields(node):
                setattr(probe, name, [*value] if isinstance(value, list) else value)
            if not changed(probe, k):
                break
            if is_tried(next(total)):
                tree = ast.parse(text)
                changed(next(itertools.islice(ast.walk(tree), number, None)), k)
                if (other := ast.unparse(tree)) != text:  # not two equal entries exchanged
                    yield other


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


class Mutated:
    """The compiled text of a monitor, of which each change is run against its vectors."""

    def __init__(self, monitor: BoundMonitor, folder: Path) -> None:
        files = files_of(monitor)
        self.vectors, self.kills = folder / "vectors.json", 0
        self.vectors.write_bytes(files[VECTORS])
        for name in files:
            if name.endswith(".bin"):  # a table of the text
                (folder / name).write_bytes(files[name])
        self.spec = spec_from_file_location("compiled", folder / "compiled.py")
        text = files["compiled.py"].decode()
        self.head, _, body = text.partition("\n# sha256 of the lines below")
        self.body = ast.unparse(ast.parse(body.partition("\n")[2]))
        self.text = ""  # of the last survivor
        is_killed, self.original = self.killed(self.body)
        assert not is_killed

    def killed(self, text: str) -> tuple[bool, Any]:
        """Return whether the vectors see a change, and the class ``Monitor`` of the text."""
        scope: dict[str, Any] = {"__name__": "compiled", "__file__": "", "__spec__": self.spec}
        try:
            exec(f"{self.head}\n{text}", scope)
            found = failures(str(self.vectors), scope["Monitor"], input_class(scope["Monitor"]))
        except Exception:  # noqa: BLE001 - a mutant that cannot run is seen
            return True, None
        return bool(found), scope["Monitor"]

    def drawn(self, request: pytest.FixtureRequest, share: float) -> Callable[[int], bool]:
        """Return which mutants are tried: all in the long profile, else a share."""
        is_long = request.config.getoption("--hypothesis-profile") == "long"
        draw = Random(1)
        return lambda _: is_long or draw.random() < share

    def survivors(
        self, is_tried: Callable[[int], bool] = lambda _: True
    ) -> Iterator[tuple[tuple[str, str], Any]]:
        """Yield what changed in each mutant that is not killed, and its class ``Monitor``.

        The change is a line before and after. What only names the model and the digest of its
        text does not count.
        """
        for text in mutants(self.body, is_tried):
            is_killed, mutant = self.killed(text)
            self.kills += is_killed
            own = self.original
            is_about = mutant and (mutant.model_id, mutant.digest) != (own.model_id, own.digest)
            if not is_killed and not is_about:
                self.text = f"{self.head}\n{text}"
                lines = ndiff(self.body.splitlines(), text.splitlines())
                before, after = (line[1:].strip() for line in lines if line[0] in "-+")
                yield (before, after), mutant
