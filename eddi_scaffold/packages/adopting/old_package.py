"""Files of an old package, and its Python modules: what people edited, and the rest.

Nothing is executed: syntax trees and lines of text only.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import takewhile
from pathlib import Path

from eddi_scaffold.common.escaping import parse_shallow
from eddi_scaffold.common.files import read_source
from eddi_scaffold.common.identifiers import is_package_name, package_name
from eddi_scaffold.common.problems import EddiError, Place, problem
from eddi_scaffold.regions.marked_file import split_lines
from eddi_scaffold.regions.markers import Marker, indent_of, read_marker
from eddi_scaffold.regions.package import entries

_CODING = re.compile(r"#.*coding[:=]")
_MODELS = (".xdsl", ".xmlbif", ".yml", ".yaml", ".xml")
_RECORDS = ".eddi"
_EDITED = ("EDDIInput.py", "bayesian_network_config.py")
_MANIFEST = "package.xml"
_NAME = re.compile(rb"<name>\s*([A-Za-z0-9_-]+)\s*</name>")


@dataclass(frozen=True)
class Body:
    """What a person wrote into a method: lines with their ends, and the blanks before it."""

    text: str
    indent: str


@dataclass(frozen=True)
class Method:
    """One method of a class."""

    name: str
    tree: ast.FunctionDef
    body: Body | None  # between the markers; `None` where there are none
    outside: tuple[ast.stmt, ...]  # its statements that lie outside of the markers

    @property
    def arguments(self) -> tuple[str, ...]:
        """The names of its arguments, without ``self``."""
        return tuple(argument.arg for argument in self.tree.args.args[1:])


@dataclass(frozen=True)
class ParsedModule:
    """One module."""

    path: Path
    lines: Sequence[str]  # of the file, which end with a line feed
    methods: dict[str, Method]  # of its classes, by name
    other: Sequence[ast.stmt]  # statements that are neither an import, a class nor a docstring
    imports: Sequence[ast.stmt]
    header: str  # comments above all else, such as of a licence

    def text_of(self, node: ast.stmt) -> str:
        """Return the lines of a statement, with its decorators and comments above."""
        decorators = getattr(node, "decorator_list", ())
        start = min([node.lineno, *(decorator.lineno for decorator in decorators)]) - 1
        while not node.col_offset and start and self.lines[start - 1].startswith("#"):
            start -= 1
        return "".join(self.lines[start : node.end_lineno]).rstrip("\n")

    def whole_body(self, method: Method) -> Body | None:
        """Return all statements of a method without markers, its comments included.

        ``None`` for one that holds nothing but the assignment of None that was generated.
        """
        match [node for node in method.outside if not isinstance(node, ast.Pass)]:
            case [] | [ast.Assign(value=ast.Constant(value=None))]:
                return None
        head, first = method.tree.lineno, method.tree.body[0].lineno
        above = range(head + 1, first)
        start = next((n for n in above if self.lines[n - 1].strip().startswith("#")), first)
        text = "".join(
            line
            for line in self.lines[start - 1 : method.tree.end_lineno]
            if line.strip().upper() != "# TODO"
        )
        return Body(text if text.endswith("\n") else f"{text}\n", indent_of(self.lines[first - 1]))


def read_module(path: Path) -> ParsedModule:
    """Read a module; EddiError if it is no Python (A001) or has damaged markers (H010)."""
    data = read_source(path).data
    try:
        text = data.decode("utf-8-sig").replace("\r\n", "\n").replace("\r", "\n")  # as Python
        tree = parse_shallow(text)
    except UnicodeDecodeError as failed:
        place = Place(str(path), data.count(b"\n", 0, failed.start) + 1)
        raise EddiError(problem("A001.encoding", place)) from None
    except SyntaxError as failed:
        place = Place(str(path), failed.lineno, failed.offset)
        raise EddiError(problem("A001.syntax", place, msg=failed.msg)) from None
    lines = split_lines(text)
    classes = [node for node in tree.body if isinstance(node, ast.ClassDef)]
    functions = [f for node in classes for f in node.body if isinstance(f, ast.FunctionDef)]
    if faults := [fault for function in functions for fault in _faults(function, lines)]:
        places = ((Place(str(path), line), reason) for line, reason in faults)
        raise EddiError(*(problem("H010", place, reason=reason) for place, reason in places))
    kinds = (ast.Import, ast.ImportFrom, ast.ClassDef)
    return ParsedModule(
        path,
        lines,
        methods={function.name: _method(function, lines) for function in functions},
        other=[node for node in tree.body if not (isinstance(node, kinds) or _is_text(node))],
        imports=[node for node in tree.body if isinstance(node, ast.Import | ast.ImportFrom)],
        header=_header(lines),
    )


def _header(lines: Sequence[str]) -> str:
    """Return the comments at the top, without what Python and the system read in them."""
    top = takewhile(lambda line: not line.strip() or line.startswith("#"), lines)
    kept = [line for line in top if not line.startswith("#!") and not _CODING.match(line)]
    text = "".join(kept).strip("\n")
    return f"{text}\n" if text else ""


def _markers(tree: ast.FunctionDef, lines: Sequence[str]) -> Iterator[tuple[int, Marker | str]]:
    for number in range(tree.lineno, (tree.end_lineno or tree.lineno) + 1):
        marker = read_marker(lines[number - 1], number)
        if marker is not None:
            yield number, marker


def _method(tree: ast.FunctionDef, lines: Sequence[str]) -> Method:
    marked = [number for number, _ in _markers(tree, lines)]
    outside = [node for node in tree.body if not _is_text(node)]
    if not marked:
        return Method(tree.name, tree, None, tuple(outside))
    begin, end = marked[0], marked[-1]
    inside = (number for number in range(begin + 1, end) if number not in marked)
    body = Body("".join(lines[number - 1] for number in inside), indent_of(lines[begin - 1]))
    outside = [node for node in outside if not begin < node.lineno < end]
    return Method(tree.name, tree, body, tuple(outside))


def _faults(tree: ast.FunctionDef, lines: Sequence[str]) -> Iterator[tuple[int, str]]:
    """Yield the lines of a method in which a marker is damaged, or has no counterpart, and why."""
    no_end = "the region has no end marker; put it back below the hand code"
    begin = None
    for number, marker in _markers(tree, lines):
        if isinstance(marker, str):
            yield number, marker
        elif marker.what == "begin":
            if begin is not None:
                yield begin, no_end
            begin = number
        elif begin is None:
            yield number, "end marker without begin; put the begin marker back above it"
        else:
            begin = None
    if begin is not None:
        yield begin, no_end


def _is_text(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)


@dataclass(frozen=True)
class OldPackage:
    """An old package."""

    folder: Path
    name: str | None  # of the ROS package, `None` of one that is none
    eddi_input: ParsedModule | None
    config: ParsedModule | None
    node: ParsedModule | None  # the ROS node's script
    monitor: ParsedModule | None
    models: Sequence[Path]  # files that may hold the model, the best one first
    files: Sequence[Path]  # every file, relative to the folder


def read_old_package(folder: Path) -> OldPackage:
    """Find out what a folder holds.

    Raises:
        EddiError: it is not a folder (F001), holds nothing of an old package, is one of ours or is
            a folder above packages, holds one of its modules twice (A002), or a module is
            not Python (A001) or has damaged markers (H010).
    """
    if not folder.is_dir():
        raise EddiError(problem("F001.no_folder", Place(str(folder))))
    if (folder / _RECORDS).is_dir():
        raise EddiError(problem("A002.generated", Place(str(folder))))
    files = [Path(name) for name, _ in entries(folder, {".git", "__pycache__"})]
    _check_is_one_package(folder, files)

    def only(name: str) -> ParsedModule | None:
        places = [file for file in files if file.name == name]
        if len(places) > 1:
            names = ", ".join(map(str, places))
            raise EddiError(problem("A002.several", Place(str(folder)), files=name, names=names))
        return read_module(folder / places[0]) if places else None

    eddi_input, config = map(only, _EDITED)
    if eddi_input is None and config is None:
        raise EddiError(problem("A002.nothing_to_adopt", Place(str(folder))))
    home = config.path.parent if config is not None else folder
    suffixes = {suffix: rank for rank, suffix in enumerate(_MODELS)}
    models = [
        folder / file
        for file in files
        if file.suffix.lower() in suffixes and file.name != _MANIFEST
    ]
    models.sort(key=lambda path: (suffixes[path.suffix.lower()], path.parent != home, path))
    # the name that launch files and other packages know the package by
    manifest = folder / _MANIFEST
    match = _NAME.search(read_source(manifest).data) if manifest.is_file() else None
    name = package_name(match[1].decode("ascii")) if match else ""
    known = name if is_package_name(name) else None
    node, monitor = only("RosNode.py"), only("EDDIMonitor.py")
    return OldPackage(folder, known, eddi_input, config, node, monitor, models, files)


def _check_is_one_package(folder: Path, files: Sequence[Path]) -> None:
    """Refuse a folder above packages: adopting would not make unneeded what else is in it."""
    ours = next((file for file in files if _RECORDS in file.parts), None)
    if ours is not None:
        inner = folder / Path(*ours.parts[: ours.parts.index(_RECORDS)])
        raise EddiError(problem("A002.generated_inside", Place(str(folder)), folder=inner))
    edited = {file.parent for file in files if file.name in _EDITED}
    above = {file.parent for file in files if file.name == _MANIFEST}
    inside = sorted(place for place in above for file in edited if file.is_relative_to(place))
    if inside and Path() not in above:
        raise EddiError(problem("A002.above", Place(str(folder)), folder=folder / inside[0]))
