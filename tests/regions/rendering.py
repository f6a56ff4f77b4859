"""A small stand-in for the templates: the files of a package for a list of inputs and nodes."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace
from pathlib import Path

from eddi_scaffold.regions.markers import begin_marker, end_marker

INPUT = "src/pkg/EDDIInput.py"
NETWORK = "src/pkg/bayesian_network_config.py"
MANIFEST = "package.xml"
CMAKE = "CMakeLists.txt"
FILES = (INPUT, NETWORK, MANIFEST, CMAKE)


@dataclass(frozen=True)
class Element:
    name: str
    states: tuple[str, ...] = ("Yes", "No")
    was: tuple[str, ...] = ()

    @property
    def sig(self) -> str:
        return hashlib.sha256(repr(self.states).encode()).hexdigest()[:8]


@dataclass(frozen=True)
class Package:
    elements: tuple[Element, ...]
    version: int = 1
    files: tuple[str, ...] = FILES


def region(kind: str, element: Element, body: str, indent: str = "        ") -> str:
    was = tuple(f"{kind}:{old}" for old in element.was)
    begin = begin_marker(f"{kind}:{element.name}", "python", was, element.sig)
    end = end_marker(f"{kind}:{element.name}", "python")
    return f"{indent}{begin}\n{body}{indent}{end}\n"


def eddi_input(package: Package) -> str:
    v = package.version
    out = ['"""Inputs of the monitor."""\n\n' if v < 3 else '"""What the monitor reads."""\n\n']
    out.append("from eddi_runtime import EDDIInputBase\n")
    out.append("from eddi_runtime import by_id\n" if v % 2 == 0 else "")
    out.append("\n\nclass EDDIInput(EDDIInputBase):\n    def __init__(self):\n")
    out.append("        super().__init__()\n")
    out += [f"        self.{e.name} = False\n" for e in package.elements]
    for e in package.elements:
        argument = "message" if v < 2 else "message, age=None"
        out.append(f"\n    def process_{e.name}(self, {argument}):\n")
        if v > 1:
            out.append(f'        """Set the input from version {v}."""\n')
        out.append(region("input", e, f"        self.{e.name} = message.data\n"))
        out.append("        return None\n" if v == 3 else "")
    out.append("\n    def processing(self, simulator_outputs):\n")
    out.append('        """Pass the messages on."""\n')
    out += [
        f"        self.update({e.name!r}, self.process_{e.name}, simulator_outputs)\n"
        for e in package.elements
    ]
    return "".join(out)


def network(package: Package) -> str:
    out = ["class BayesianNetworkConfig:\n    def __init__(self, eddi_input):\n"]
    out.append("        self.eddi_input = eddi_input\n")
    for e in package.elements:
        out.append(f"\n    def node_{e.name}(self):\n")
        out.append(f'        """Return the outcome (v{package.version})."""\n\n')
        out.append("        is_bn_output = False\n")
        out += [f"        outcome_{s} = 0.0\n" for s in e.states]
        out.append(region("node", e, "\n"))
        items = ",\n                ".join(f"'{s}': outcome_{s}" for s in e.states)
        out.append(f"        return is_bn_output, \\\n               {{{items}}}\n")
    return "".join(out)


def manifest(package: Package) -> str:
    depends = "".join(f"  <depend>{e.name}_msgs</depend>\n" for e in package.elements)
    return (
        f'<?xml version="1.0"?>\n<package format="{min(package.version + 1, 3)}">\n'
        f"  <name>pkg</name>\n  <version>0.{package.version}.0</version>\n\n{depends}"
        f"  {begin_marker('xml:depends', 'xml')}\n  {end_marker('xml:depends', 'xml')}\n"
        "</package>\n"
    )


def cmake(package: Package) -> str:
    return (
        f"cmake_minimum_required(VERSION 3.{package.version})\nproject(pkg)\n\n"
        "find_package(catkin REQUIRED)\ncatkin_package()\n\n"
        f"{begin_marker('cmake:install', 'hash')}\n{end_marker('cmake:install', 'hash')}\n"
    )


RENDER = {INPUT: eddi_input, NETWORK: network, MANIFEST: manifest, CMAKE: cmake}


def sentinel(path: str) -> str:
    text = "eddi-scaffold: end of rendering"
    return f"<!-- {text} -->\n" if path.endswith(".xml") else f"# {text}\n"


def render(root: Path, package: Package, records: str = ".eddi") -> None:
    """Do what Copier does: editable files only where absent, pristine copies always."""
    (root / records / "pristine").mkdir(parents=True, exist_ok=True)
    hidden = root / records / ".gitignore"
    if not hidden.exists():
        hidden.write_text("/.gitignore\n/pristine/\n/generated/\n/placed/\n")
    for path in FILES:
        pristine = root / records / "pristine" / path
        if path not in package.files:
            pristine.unlink(missing_ok=True)
            continue
        text = RENDER[path](package)
        pristine.parent.mkdir(parents=True, exist_ok=True)
        pristine.write_bytes((text + sentinel(path)).encode())
        target = root / path
        if not target.exists():
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(text.encode())


def elements(*names: str) -> tuple[Element, ...]:
    return tuple(Element(name) for name in names)


def renamed(element: Element, name: str) -> Element:
    return replace(element, name=name, was=(element.name,))


def snapshot(root: Path) -> dict[str, bytes]:
    return {
        p.relative_to(root).as_posix(): p.read_bytes()
        for p in sorted(root.rglob("*"))
        if p.is_file() and ".git/" not in p.as_posix()
    }
