"""What the old generator wrote by itself: all else outside of the markers is a person's."""

from __future__ import annotations

import ast
from collections.abc import Iterator

from eddi_scaffold.adopting.modules import Method, ParsedModule

_OWN = {"__init__", "update_dra_data", "processing"}


def foreign(module: ParsedModule, prefix: str) -> Iterator[ast.AST]:
    """Yield the statements of a module that the old generator did not write.

    Args:
        module: with one class of editable methods.
        prefix: of these (``node_`` or ``process_``).
    """
    yield from module.other
    for method in module.methods.values():
        if method.name.startswith(prefix):
            yield from (one for one in _outside(method) if not _generated(one))
        elif method.name not in _OWN:
            yield method.tree
        else:
            yield from (one for one in method.outside if not _ours(one))


def _outside(method: Method) -> tuple[ast.stmt, ...]:
    """Return the statements outside of the markers; a method without them was adopted whole."""
    return method.outside if method.body is not None or method.name.startswith("node_") else ()


def _generated(node: ast.stmt) -> bool:
    """Return whether a statement is one of Fig 15: initial values, and the result."""
    if isinstance(node, ast.Return | ast.Pass):
        return True
    if not isinstance(node, ast.Assign | ast.AnnAssign):
        return False
    targets = node.targets if isinstance(node, ast.Assign) else [node.target]
    value = node.value
    name = targets[0].id if isinstance(targets[0], ast.Name) else ""
    if not isinstance(value, ast.Constant):
        return False
    if name == "is_bn_output":
        return value.value is False
    return name.startswith("outcome_") and value.value == 0.0


def _ours(node: ast.stmt) -> bool:
    """Return whether a statement belongs to the generated frame of a class."""
    kinds = (ast.Assign, ast.AnnAssign, ast.If, ast.Return, ast.Pass, ast.Try)
    return isinstance(node, kinds) and not any(
        isinstance(one, ast.Call) and not _is_frame_call(one) for one in ast.walk(node)
    )


def _is_frame_call(call: ast.Call) -> bool:
    name = call.func.attr if isinstance(call.func, ast.Attribute) else getattr(call.func, "id", "")
    return name.startswith("process_") or name in {"hasattr", "getattr", "isinstance", "super"}
