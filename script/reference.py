#!/usr/bin/env python3
"""Write ``docs/reference/python.md`` from the docstrings of the public modules.

    script/reference.py    # after a change of a public signature or docstring

Modules are parsed, not imported: ``transports.ros1`` can be imported only where ROS is.
"""

from __future__ import annotations

import ast
import re
import textwrap
from collections.abc import Iterator
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "reference" / "python.md"
MODULES = {
    "eddi_scaffold.api": ROOT,
    "eddi_runtime": ROOT / "runtime_lib" / "src",
    "eddi_runtime.history": ROOT / "runtime_lib" / "src",
    "eddi_runtime.transports.ros1": ROOT / "runtime_lib" / "src",
}
"""Public module -> the folder of the import path that contains it."""
INTERNAL = {
    "EDDIInputBase": "setup processed bind begin_processing end_step update why known_for"
    " look_again update_each update_expression expression",
    "Model": "named as_eddi_map diagram draft companion_messages separate_outputs own_topics"
    " element_keys editable_modules readme compile cross_check claims acceptances input_timeouts"
    " elements why_not_fulfilled",
    "Monitor": "published output_faults doubts",
    "MonitorNode": "expected_types",
}
"""Class -> public methods that the generator or generated code calls, not a user."""
_HEAD = """# Reference

<!-- written by script/reference.py from the docstrings -->

Public names with their signatures, without methods that only the generator and generated code call.
For examples see [use from Python](../how-to/python.md) and [monitors at run time](runtime.md).
"""


def document() -> str:
    """Return the page of all public modules."""
    return "\n".join([_HEAD, *(_module(name, folder) for name, folder in MODULES.items())])


def _module(name: str, folder: Path) -> str:
    tree = _parsed(_path(name, folder))
    (exported,) = (
        node.value
        for node in tree.body
        if isinstance(node, ast.Assign) and _targets(node) == ["__all__"]
    )
    parts = [f"## `{name}`\n", _prose(ast.get_docstring(tree))]
    for public in ast.literal_eval(exported):
        if not public.startswith("__"):
            parts += [f"### `{public}`\n", *_entry(public, name, folder)]
    return "\n".join(parts)


def _entry(name: str, module: str, folder: Path) -> Iterator[str]:
    """Yield the Markdown of one name: its code, its docstring, the public methods of a class."""
    module, node, docstring = _definition(name, module, folder)
    path = _path(module, folder)
    match node:
        case ast.ClassDef():
            yield _code(path, *_class_lines(node, path.read_text("utf-8").splitlines()))
        case ast.FunctionDef():
            yield _code(path, _head(node))
        case _:
            yield _code(path, (node.lineno, node.end_lineno or node.lineno))
    yield _prose(docstring)
    match node:
        case ast.ClassDef():
            for method in node.body:
                if not isinstance(method, ast.FunctionDef) or method.name.startswith("_"):
                    continue
                if method.name in INTERNAL.get(name, "").split():
                    continue
                if ast.get_docstring(method):  # else its base class says what it is
                    yield f"#### `{name}.{method.name}`\n"
                    yield _code(path, _head(method))
                    yield _prose(ast.get_docstring(method))
        case ast.Assign(value=ast.Subscript(value=ast.Name(id=generic))):
            yield from _entry(generic, module, folder)


def _definition(name: str, module: str, folder: Path) -> tuple[str, ast.stmt, str | None]:
    """Return the module, statement and docstring that define a name, followed through imports.

    Raises:
        LookupError: the module neither defines nor imports that name.
    """
    path = _path(module, folder)
    body = _parsed(path).body
    for node, below in zip(body, [*body[1:], None], strict=True):
        match node:
            case ast.ClassDef() | ast.FunctionDef() if node.name == name:
                return module, node, ast.get_docstring(node)
            case ast.Assign() if name in _targets(node):
                return module, node, _text(below)
            case ast.ImportFrom() if name in [one.name for one in node.names]:
                return _definition(name, _imported(node, module, path), folder)
    raise LookupError(f"{module} has no {name}")


def _imported(node: ast.ImportFrom, module: str, path: Path) -> str:
    """Return the full name of the module of ``from ... import``."""
    parts = module.split(".")
    package = parts if path.name == "__init__.py" else parts[:-1]
    above = package[: len(package) - node.level + 1] if node.level else []
    return ".".join([*above, *([node.module] if node.module else [])])


def _targets(node: ast.Assign) -> list[str]:
    return [ast.unparse(target) for target in node.targets]


def _text(node: ast.stmt | None) -> str | None:
    """Return the text below an assignment, which documents it."""
    match node:
        case ast.Expr(value=ast.Constant(value=str(text))):
            return text
    return None


def _class_lines(node: ast.ClassDef, lines: list[str]) -> Iterator[tuple[int, int]]:
    """Yield the lines of the head, of the public fields and of the signature of ``__init__``.

    Comments above a field are its description.
    """
    yield _head(node)
    for part in node.body:
        if isinstance(part, ast.AnnAssign) and not ast.unparse(part.target).startswith("_"):
            first = part.lineno
            while lines[first - 2].lstrip().startswith("#"):
                first -= 1
            yield first, part.end_lineno or part.lineno
        if isinstance(part, ast.FunctionDef) and part.name == "__init__":
            yield _head(part)


def _head(node: ast.ClassDef | ast.FunctionDef) -> tuple[int, int]:
    first = min([node.lineno, *(one.lineno for one in node.decorator_list)])
    return first, node.body[0].lineno - 1


def _code(path: Path, *parts: tuple[int, int]) -> str:
    lines = path.read_text("utf-8").splitlines()
    kept = [line for first, last in parts for line in lines[first - 1 : last] if line.strip()]
    code = textwrap.dedent("\n".join(kept))
    return f"```python\n{code}\n```\n"


def _prose(docstring: str | None) -> str:
    """Return a Google docstring as Markdown, its sections of names as lists."""
    paragraphs = re.split(r"\n\n+", (docstring or "").strip().replace("``", "`"))
    return "\n".join(_paragraph(one) for one in paragraphs if one)


def _paragraph(text: str) -> str:
    title, _, rest = text.partition("\n")
    if not (title.endswith(":") and rest.startswith("    ")):
        return f"{text}\n"
    items = [" ".join(one.split()) for one in re.split(r"\n(?! )", textwrap.dedent(rest))]
    if all(re.match(r"\w+: ", one) for one in items):
        names = (re.sub(r"^(\w+): ", r"- `\1`: ", one) for one in items)
        return "\n".join([f"{title}\n", *names, ""])
    return f"{title} {' '.join(items)}\n"


def _path(module: str, folder: Path) -> Path:
    path = folder.joinpath(*module.split("."))
    return path / "__init__.py" if path.is_dir() else path.with_suffix(".py")


@cache
def _parsed(path: Path) -> ast.Module:
    return ast.parse(path.read_text("utf-8"))


if __name__ == "__main__":
    PAGE.write_text(document(), "utf-8")
