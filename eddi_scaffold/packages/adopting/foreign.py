"""Statements of an old module that the old generator did not write."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from eddi_scaffold.packages.adopting.old_package import ParsedModule


def foreign(module: ParsedModule, prefix: str) -> Iterator[ast.stmt]:
    """Yield the statements of a module that the old generator did not write.

    Its editable methods begin with a prefix, ``node_`` or ``process_``.
    """
    yield from module.other
    for method in module.methods.values():
        if method.name.startswith(prefix):  # a process method without markers is adopted whole
            adopted = method.body is None and not method.name.startswith("node_")
            yield from (s for s in method.outside if not adopted and not _is_of_fig_15(s))
        elif method.name in {"__init__", "update_dra_data", "processing"}:
            yield from (statement for statement in method.outside if not _is_frame(statement))
        else:
            yield method.tree


def _is_of_fig_15(node: ast.stmt) -> bool:
    """Return whether a statement of a node's method is an initial value, or the result."""
    match node:
        case ast.Return() | ast.Pass():
            return True
        case (
            ast.Assign(targets=[ast.Name(id=name), *_], value=ast.Constant(value=value))
            | ast.AnnAssign(target=ast.Name(id=name), value=ast.Constant(value=value))
        ):
            return (
                value is False
                if name == "is_bn_output"
                else (name.startswith("outcome_") and value == 0.0)
            )
    return False


def _is_frame(node: ast.stmt) -> bool:
    """Return whether a statement belongs to the generated frame of a class."""
    names = [
        call.func.attr if isinstance(call.func, ast.Attribute) else getattr(call.func, "id", "")
        for call in ast.walk(node)
        if isinstance(call, ast.Call)
    ]
    kinds = (ast.Assign, ast.AnnAssign, ast.If, ast.Return, ast.Pass, ast.Try)
    called = {"hasattr", "getattr", "isinstance", "super"}
    return isinstance(node, kinds) and all(
        name.startswith("process_") or name in called for name in names
    )
