"""Files of an old package, and its Python modules: what people edited, and the rest.

Nothing is executed: syntax trees and lines of text only.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from eddi_scaffold.common.escaping import parse_shallow
from eddi_scaffold.common.files import read_source
from eddi_scaffold.common.identifiers import is_package_name, package_name
from eddi_scaffold.common.problems import EddiError, Place, problem
from eddi_scaffold.regions.marked_file import Region, parse, split_lines
from eddi_scaffold.regions.markers import UNKNOWN, begin_marker, end_marker, indent_of
from eddi_scaffold.regions.package import entries

_MODELS = (".xdsl", ".xmlbif", ".yml", ".yaml", ".xml")
_RECORDS = ".eddi"
_EDITED = ("EDDIInput.py", "bayesian_network_config.py")
_MANIFEST = "package.xml"
_NAME = re.compile(rb"<name>\s*([A-Za-z0-9_-]+)\s*</name>")


@dataclass(frozen=True)
class Method:
    """One method of a class."""

    name: str
    tree: ast.FunctionDef
    region: Region | None  # `None` without markers
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
    imports: Sequence[ast.Import | ast.ImportFrom]

    def text_of(self, node: ast.stmt) -> str:
        """Return the lines of a statement, with its decorators and comments above."""
        decorators = getattr(node, "decorator_list", ())
        start = min([node.lineno, *(decorator.lineno for decorator in decorators)]) - 1
        while not node.col_offset and start and self.lines[start - 1].startswith("#"):
            start -= 1
        return "".join(self.lines[start : node.end_lineno]).rstrip("\n")

    def whole_body(self, method: Method) -> Region | None:
        """Return all statements of a method without markers, its comments included.

        ``None`` for one that holds nothing but the assignment of None that was generated.
        """
        match [node for node in method.outside if not isinstance(node, ast.Pass)]:
            case [] | [ast.Assign(value=ast.Constant(value=None))]:
                return None
        head, first = method.tree.lineno, method.tree.body[0].lineno
        above = range(head + 1, first)
        start = next((n for n in above if self.lines[n - 1].strip().startswith("#")), first)
        lines = self.lines[start - 1 : method.tree.end_lineno]
        text = "".join(line for line in lines if line.strip().upper() != "# TODO").rstrip("\n")
        indent, id_ = indent_of(self.lines[first - 1]), method.name
        begin, end = f"{indent}{begin_marker(id_)}", f"{indent}{end_marker(id_)}"
        return Region(id_, UNKNOWN, (), None, 1, begin, f"{text}\n", end)


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
    texts = {f: "".join(lines[f.lineno - 1 : f.end_lineno]) for f in functions}
    faults = [(f.lineno - 1, fault) for f, text in texts.items() for fault in parse(text)[1]]
    if faults:
        places = ((Place(str(path), above + of.line), of.reason) for above, of in faults)
        raise EddiError(*(problem("H010", place, reason=reason) for place, reason in places))
    kinds = (ast.Import, ast.ImportFrom, ast.ClassDef)
    return ParsedModule(
        path,
        lines,
        methods={f.name: _method(f, text) for f, text in texts.items()},
        other=[node for node in tree.body if not (isinstance(node, kinds) or _is_text(node))],
        imports=[node for node in tree.body if isinstance(node, ast.Import | ast.ImportFrom)],
    )


def _method(tree: ast.FunctionDef, text: str) -> Method:
    region = next(iter(parse(text)[0].regions.values()), None)
    begin = tree.lineno + region.line if region else 0  # line below the begin marker
    inside = range(begin, begin + region.body.count("\n")) if region else ()
    outside = (node for node in tree.body if not _is_text(node) and node.lineno not in inside)
    return Method(tree.name, tree, region, tuple(outside))


def _is_text(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)


def foreign(module: ParsedModule, prefix: str) -> Iterator[ast.stmt]:
    """Yield the statements of a module that the old generator did not write.

    Its editable methods begin with a prefix, ``node_`` or ``process_``.
    """
    yield from (import_ for import_ in module.imports if not _is_frame_import(import_))
    yield from module.other
    for method in module.methods.values():
        if method.name.startswith(prefix):  # a process method without markers is adopted whole
            adopted = method.region is None and not method.name.startswith("node_")
            yield from (s for s in method.outside if not adopted and not _is_of_fig_15(s))
        elif method.name in {"__init__", "update_dra_data", "processing"}:
            yield from (statement for statement in method.outside if not _is_frame(statement))
        else:
            yield method.tree


def _is_frame_import(node: ast.Import | ast.ImportFrom) -> bool:
    names, module = [alias.name for alias in node.names], getattr(node, "module", None) or ""
    return module in {"typing", "__future__"} or module.endswith(".msg") or names == ["rospy"]


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


def read_old_package(folder: Path) -> OldPackage:
    """Find out what a folder holds.

    Raises:
        EddiError: it is not a folder (F001), holds nothing of an old package, is one of ours, holds
            one of its modules twice (A002), or a module is not Python (A001) or has damaged
            markers (H010).
    """
    if not folder.is_dir():
        raise EddiError(problem("F001.no_folder", Place(str(folder))))
    if (folder / _RECORDS).is_dir():
        raise EddiError(problem("A002.generated", Place(str(folder))))
    files = [Path(name) for name, _ in entries(folder, {".git", "__pycache__"})]

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
    return OldPackage(folder, known, eddi_input, config, node, monitor, models)
