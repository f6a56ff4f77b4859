"""Files of an old package, and its Python modules: what people edited, and the rest.

Nothing is executed: syntax trees and lines of text only.
"""

from __future__ import annotations

import ast
import os
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
from eddi_scaffold.regions.markers import indent_of, read_marker

_CODING = re.compile(r"#.*coding[:=]")
_NO_END = "the region has no end marker; put it back below the hand code"
_MARKER = re.compile(r"(?<!-)-{3,}\s*Manual edit (begin|end)\s*-{3,}", re.IGNORECASE)


@dataclass(frozen=True)
class Body:
    """What a person wrote into a method.

    Attributes:
        text: lines, with their line ends.
        indent: blanks before it.
        line: where it begins.
    """

    text: str
    indent: str
    line: int


@dataclass(frozen=True)
class Method:
    """One method of a class.

    Attributes:
        tree: its syntax tree.
        body: between the markers; ``None`` where there are none.
        outside: its statements that lie outside of the markers.
    """

    name: str
    tree: ast.FunctionDef
    body: Body | None
    outside: tuple[ast.stmt, ...]

    @property
    def arguments(self) -> tuple[str, ...]:
        """The names of its arguments, without ``self``."""
        return tuple(argument.arg for argument in self.tree.args.args[1:])


@dataclass(frozen=True)
class ParsedModule:
    """One module.

    Attributes:
        path: of the file.
        lines: of the file, which end with a line feed.
        methods: of its classes, by name.
        other: statements that are neither an import, a class nor a docstring.
        imports: import statements.
        header: comments above all else, such as of a licence.
    """

    path: Path
    lines: tuple[str, ...]
    methods: dict[str, Method]
    other: tuple[ast.stmt, ...]
    imports: tuple[ast.stmt, ...]
    header: str

    def segment(self, node: ast.AST) -> str:
        """Return the source of a statement."""
        if not isinstance(node, ast.stmt):
            return ""
        lines = [line.encode() for line in self.lines[node.lineno - 1 : node.end_lineno]]
        lines[-1] = lines[-1][: node.end_col_offset]
        before = lines[0][: node.col_offset].decode()
        lines[0] = re.sub(r"\S", " ", before).encode() + lines[0][node.col_offset :]
        return b"".join(lines).decode()

    def commented(self, node: ast.AST) -> str:
        """Return the source of a statement with its decorators, and comments above and behind."""
        text = self.segment(node)
        if not isinstance(node, ast.stmt) or node.end_lineno is None:
            return text
        behind = self.lines[node.end_lineno - 1].encode()[node.end_col_offset :].decode().rstrip()
        if behind.lstrip().startswith("#"):
            text += behind
        decorators = getattr(node, "decorator_list", ())
        start = min([node.lineno, *(decorator.lineno for decorator in decorators)]) - 1
        while not node.col_offset and start and self.lines[start - 1].startswith("#"):
            start -= 1
        return "".join(self.lines[start : node.lineno - 1]) + text


def read_module(path: Path) -> ParsedModule:
    """Read a module.

    Raises:
        EddiError: it is not UTF-8 text or no Python (A001), or has damaged markers (H010).
    """
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
    methods: dict[str, Method] = {}
    other: list[ast.stmt] = []
    imports: list[ast.stmt] = []
    for node in tree.body:
        if isinstance(node, ast.ClassDef):
            functions = [one for one in node.body if isinstance(one, ast.FunctionDef)]
            faults = [fault for function in functions for fault in _faults(function, lines)]
            if faults:
                raise EddiError(
                    *(
                        problem("H010", Place(str(path), line), reason=reason)
                        for line, reason in faults
                    )
                )
            methods |= {function.name: _method(function, lines) for function in functions}
        elif isinstance(node, ast.Import | ast.ImportFrom):
            imports.append(node)
        elif not _is_text(node):
            other.append(node)
    return ParsedModule(path, tuple(lines), methods, tuple(other), tuple(imports), _header(lines))


def _header(lines: Sequence[str]) -> str:
    """Return the comments at the top, without what Python and the system read in them."""
    top = takewhile(lambda line: not line.strip() or line.startswith("#"), lines)
    kept = [line for line in top if not line.startswith("#!") and not _CODING.match(line)]
    text = "".join(kept).strip("\n")
    return f"{text}\n" if text else ""


def _method(tree: ast.FunctionDef, lines: Sequence[str]) -> Method:
    marks = list(_marks(tree, lines))
    statements = tuple(one for one in tree.body if not _is_text(one))
    if not marks:
        return Method(tree.name, tree, None, statements)
    begin, end = marks[0][1], marks[-1][1] - 1
    inner = {line for _, line in marks}
    text = "".join(lines[n - 1] for n in range(begin + 1, end + 1) if n not in inner)
    indent = indent_of(lines[begin - 1])
    outside = tuple(statement for statement in statements if not begin < statement.lineno <= end)
    return Method(tree.name, tree, Body(text, indent, begin + 1), outside)


def _faults(tree: ast.FunctionDef, lines: Sequence[str]) -> Iterator[tuple[int, str]]:
    """Yield the lines of a method in which a marker is damaged, or has no counterpart, and why."""
    for number in range(tree.lineno, (tree.end_lineno or tree.lineno) + 1):
        reason = read_marker(lines[number - 1], number)
        if isinstance(reason, str):
            yield number, reason
    begin = None
    for what, number in _marks(tree, lines):
        if what == "end" and begin is None:
            yield number, "end marker without begin; put the begin marker back above it"
        elif what == "begin" and begin is not None:
            yield begin, _NO_END
        begin = number if what == "begin" else None
    if begin is not None:
        yield begin, _NO_END


def _marks(tree: ast.FunctionDef, lines: Sequence[str]) -> Iterator[tuple[str, int]]:
    """Yield the text of each marker and its line: a string alone on its line, or a comment."""
    for number in range(tree.lineno, (tree.end_lineno or tree.lineno) + 1):
        match = _MARKER.search(lines[number - 1])
        before = lines[number - 1][: match.start()].strip() if match else "x"
        if match and before in {"", "#", "'''", '"""', "'", '"'}:
            yield match[1].lower(), number


def _is_text(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)


def whole_body(method: Method, module: ParsedModule) -> Body | None:
    """Return all statements of a method without markers, its comments included.

    ``None`` for one that holds nothing but the assignment of None that was generated.
    """
    statements = [one for one in method.tree.body if not _is_text(one)]
    real = [statement for statement in statements if not isinstance(statement, ast.Pass)]
    if not real or (len(real) == 1 and _assigns_none(real[0])):
        return None
    lines = module.lines
    first = method.tree.body[0].lineno
    start = next(
        (
            n
            for n in range(method.tree.lineno + 1, first + 1)
            if lines[n - 1].strip().startswith("#")
        ),
        first,
    )
    text = [
        line
        for line in lines[start - 1 : method.tree.end_lineno]
        if line.strip().upper() != "# TODO"
    ]
    if text and not text[-1].endswith("\n"):
        text[-1] += "\n"
    return Body("".join(text), indent_of(lines[first - 1]), start)


def _assigns_none(node: ast.stmt) -> bool:
    return (
        isinstance(node, ast.Assign)
        and isinstance(node.value, ast.Constant)
        and node.value.value is None
    )


_MODELS = (".xdsl", ".xmlbif", ".yml", ".yaml", ".xml")
_RECORDS = ".eddi"
_EDITED = ("EDDIInput.py", "bayesian_network_config.py")
_MANIFEST = "package.xml"
_NAME = re.compile(rb"<name>\s*([A-Za-z0-9_-]+)\s*</name>")


@dataclass(frozen=True)
class OldPackage:
    """An old package.

    Attributes:
        name: of the ROS package, ``None`` of one that is none.
        eddi_input: ``EDDIInput.py``.
        config: ``bayesian_network_config.py``.
        node: the ROS node's script.
        monitor: ``EDDIMonitor.py``.
        models: files that may hold the model, the best one first.
        files: every file, relative to the folder.
    """

    folder: Path
    name: str | None
    eddi_input: ParsedModule | None
    config: ParsedModule | None
    node: ParsedModule | None
    monitor: ParsedModule | None
    models: tuple[Path, ...]
    files: tuple[Path, ...]


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
    files = tuple(_files(folder))
    _check_is_one_package(folder, files)
    eddi_input = _only(folder, files, "EDDIInput.py")
    config = _only(folder, files, "bayesian_network_config.py")
    if eddi_input is None and config is None:
        raise EddiError(problem("A002.nothing_to_adopt", Place(str(folder))))
    near = config.path.parent if config is not None else folder
    models = [
        folder / file for file in files if file.suffix.lower() in _MODELS and file.name != _MANIFEST
    ]
    models.sort(key=lambda path: (_MODELS.index(path.suffix.lower()), path.parent != near, path))
    node = _only(folder, files, "RosNode.py")
    monitor = _only(folder, files, "EDDIMonitor.py")
    name = _package_name(folder)
    return OldPackage(folder, name, eddi_input, config, node, monitor, tuple(models), files)


def _check_is_one_package(folder: Path, files: Sequence[Path]) -> None:
    """Refuse a folder above packages: what else is in it is nothing that adopting makes unneeded.

    Raises:
        EddiError: one below it is a package, of ours or of the old tools (A002).
    """
    ours = next((file for file in files if _RECORDS in file.parts), None)
    if ours is not None:
        inner = folder / Path(*ours.parts[: ours.parts.index(_RECORDS)])
        raise EddiError(problem("A002.generated_inside", Place(str(folder)), folder=inner))
    edited = {file.parent for file in files if file.name in _EDITED}
    above = {file.parent for file in files if file.name == _MANIFEST}
    if Path() in above:
        return
    inner_packages = sorted(one for one in above for file in edited if file.is_relative_to(one))
    if inner_packages:
        raise EddiError(
            problem("A002.above", Place(str(folder)), folder=folder / inner_packages[0])
        )


def _package_name(folder: Path) -> str | None:
    """Return the name that launch files and other packages know the package by."""
    manifest = folder / _MANIFEST
    found = _NAME.search(read_source(manifest).data) if manifest.is_file() else None
    name = package_name(found[1].decode("ascii")) if found else ""
    return name if is_package_name(name) else None


def _files(folder: Path) -> Sequence[Path]:
    skipped = {".git", "__pycache__"}
    found = []
    for root, folders, names in os.walk(folder):
        folders[:] = sorted(name for name in folders if name not in skipped)
        found += [Path(root, name).relative_to(folder) for name in sorted(names)]
    return found


def _only(folder: Path, files: Sequence[Path], name: str) -> ParsedModule | None:
    found = [file for file in files if file.name == name]
    if len(found) > 1:
        listed = ", ".join(map(str, found))
        raise EddiError(problem("A002.several", Place(str(folder)), files=name, names=listed))
    return read_module(folder / found[0]) if found else None
