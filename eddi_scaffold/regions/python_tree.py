"""Python text as a tree of definitions, each with the lines that belong to it.

Comments, blank lines and decorators stick to the definition below them; comments that are
indented deeper than the block stay with the definition above.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from .formatting import framed
from .items import Block, Item, Leaf, numbered
from .marked_file import placeholder_id, split_lines
from .markers import indent_of
from .python_text import parse_shallow

TAIL = "<tail>"


@dataclass(frozen=True)
class _Span:
    node: ast.stmt
    start: int
    stop: int


def is_named(key: str) -> bool:
    """Return whether a key stays the same when the item's text is edited."""
    return key.startswith(("def ", "class ", "from ", "import ", "= ", "region ", "<"))


def split(lines: Sequence[str]) -> tuple[Item, ...]:
    """Return the module's definitions; their lines joined give the input again.

    Raises:
        SyntaxError: the text does not parse.
    """
    text = "".join(lines)
    if "\r" in text or "\f" in text:
        raise SyntaxError("carriage returns or form feeds inside of lines")
    return tuple(numbered(_block(parse_shallow(text).body, lines, 0, len(lines))))


def split_function(lines: Sequence[str]) -> Block | None:
    """Return the statements of one function, ``None`` where control flow decides their order."""
    text = framed(lines)
    shown = split_lines(text)
    try:
        node = parse_shallow(text).body[0]
    except (SyntaxError, IndexError):
        return None
    if isinstance(node, ast.If):
        node = node.body[0]
    if not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
        return None
    if node.body[0].lineno <= node.lineno or any(hasattr(inner, "body") for inner in node.body):
        return None
    offset = len(shown) - len(lines)
    first = _above(shown, node.body[0].lineno - 1)
    members = tuple(numbered(_block(node.body, shown, first, len(shown))))
    return Block(f"def {node.name}", tuple(shown[offset:first]), members)


def _block(nodes: Sequence[ast.stmt], lines: Sequence[str], start: int, stop: int) -> list[Item]:
    spans = list(_spans(nodes))
    items: list[Item] = []
    at = start
    for number, span in enumerate(spans):
        following = spans[number + 1].start if number + 1 < len(spans) else stop
        end = _with_comments(lines, span, following)
        items.append(_item(span, lines, at, end))
        at = end
    if at < stop:
        items.append(Leaf(TAIL, tuple(lines[at:stop])))
    return items


def _spans(nodes: Sequence[ast.stmt]) -> Iterator[_Span]:
    current: _Span | None = None
    for node in nodes:
        decorators: list[ast.expr] = getattr(node, "decorator_list", [])
        start = min([node.lineno, *(d.lineno for d in decorators)]) - 1
        stop = node.end_lineno or node.lineno
        if current is not None and start < current.stop:  # several statements on one line
            current = _Span(current.node, current.start, max(stop, current.stop))
            continue
        if current is not None:
            yield current
        current = _Span(node, start, stop)
    if current is not None:
        yield current


def _with_comments(lines: Sequence[str], span: _Span, following: int) -> int:
    end = span.stop
    for number in range(span.stop, following):
        line = lines[number]
        if line.strip():
            if len(indent_of(line)) <= span.node.col_offset:
                break
            end = number + 1
    return end


def _item(span: _Span, lines: Sequence[str], start: int, stop: int) -> Item:
    node, key = span.node, _key(span.node, lines[span.start])
    if not isinstance(node, ast.ClassDef) or node.body[0].lineno <= node.lineno:
        return Leaf(key, tuple(lines[start:stop]))
    first = _above(lines, next(_spans(node.body)).start)
    members = tuple(numbered(_block(node.body, lines, first, stop)))
    return Block(key, tuple(lines[start:first]), members)


def _above(lines: Sequence[str], first: int) -> int:
    """Return where the comments and blank lines above a line begin."""
    while not lines[first - 1].strip() or lines[first - 1].lstrip().startswith("#"):
        first -= 1
    return first


def _key(node: ast.stmt, line: str) -> str:
    region = placeholder_id(line)
    if region is not None:
        return f"region {region}"
    if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
        accessors = [d.attr for d in node.decorator_list if isinstance(d, ast.Attribute)]
        kind = next((a for a in accessors if a in {"setter", "deleter", "getter"}), "")
        return f"def {node.name} {kind}".rstrip()
    if isinstance(node, ast.ClassDef):
        return f"class {node.name}"
    if isinstance(node, ast.ImportFrom):
        return f"from {'.' * node.level}{node.module or ''}"
    if isinstance(node, ast.Assign):
        return "= " + ", ".join(ast.unparse(target) for target in node.targets)
    if isinstance(node, ast.AnnAssign):
        return "= " + ast.unparse(node.target)
    if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
        return "<docstring>"
    if hasattr(node, "body"):
        return line.strip()
    return ast.unparse(node)
