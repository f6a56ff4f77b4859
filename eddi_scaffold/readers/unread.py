"""What no monitor is made of: packages of an EDDI that nothing reads, and XML that is not an EDDI.

Models in them would otherwise be lost without a word.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from eddi_scaffold.problems import Problem, error, warning
from eddi_scaffold.readers.classes import CLASSES
from eddi_scaffold.readers.spelling import fold, local_name
from eddi_scaffold.readers.survey import MONITORED, kind_of_model
from eddi_scaffold.readers.xmi import feature_of

if TYPE_CHECKING:
    from eddi_scaffold.readers.document import EddiDocument
    from eddi_scaffold.readers.xmi import Element

_READ = frozenset({"consertpackage", "ddipackage", "designpackage", "failurelogicpackage"})
"""Packages that readers look into, whether or not there is a model in them."""
_LEFT_OUT = frozenset({"attacktree", "fmea", "fmeda"})
"""Models of which no monitors are generated."""
_ODE = re.compile(r"[/.-](deis|sesame|mergedode|ode|sacm)(?![a-z])", re.IGNORECASE)
"""Names in the namespaces of all generations of the metamodel."""
_LOOKS_LIKE = {
    "launch": "a launch file",
    "opsa-mef": "an Open-PSA model",
    "package": "the package.xml of a ROS package",
    "pnml": "a Petri net",
    "robot": "a URDF",
    "sdf": "an SDF world or model",
    "svg": "a picture",
}


def unread(document: EddiDocument) -> Iterator[Problem]:
    """Yield a warning (X021) for each class of packages and models that nothing reads."""
    classes: dict[str, list[Element]] = {}
    for element in _unread_elements(document):
        classes.setdefault(_class_of(document, element), []).append(element)
    for stated, same in classes.items():
        yield _not_read(document, stated, same)


def foreign(document: EddiDocument) -> Problem | None:
    """Return F010 for XML that is not an EDDI by any of its roots, ``None`` for one that may be."""
    if any(_may_be_ours(document, root) for root in document.roots):
        return None
    root = document.roots[0] if document.roots else document.document
    name = feature_of(root)
    looks = _LOOKS_LIKE.get(local_name(name))
    message = f"this XML is not an EDDI: its root is <{name}>"
    message += f", so it looks like {looks}" if looks else ""
    hint = "the root of an EDDI is a DDIPackage, or one of its packages or models"
    return error("F010", message, document.place(root), hint)


def _may_be_ours(document: EddiDocument, root: Element) -> bool:
    uri = str(root.tag).rpartition("}")[0]
    return document.class_of(root).name in CLASSES or _ODE.search(uri) is not None


def _unread_elements(document: EddiDocument) -> Iterator[Element]:
    """Yield packages without a model for a monitor, and other models next to such ones."""
    packages = list(document.packages())
    known = set(packages)
    inside: set[Element] = set()
    for package in packages:
        if package.getparent() in inside:
            inside.add(package)  # reported with the enclosing package
        elif _is_read(document, package):
            children = [one for one in package.iterchildren() if one not in known]
            yield from (one for one in children if _is_left_out(document, package, one))
        elif fold(_class_of(document, package)).endswith(("package", "packages")):
            inside.add(package)
            yield package


def _is_left_out(document: EddiDocument, package: Element, child: Element) -> bool:
    """Return whether a child of a package that is read is a model which is not."""
    if document.class_of(package).name != "ddipackage":
        return document.class_of(child).name in _LEFT_OUT
    is_model = kind_of_model(document, child) in MONITORED
    return not is_model and fold(feature_of(child)) != "keyvaluemaps"


def _is_read(document: EddiDocument, package: Element) -> bool:
    if document.class_of(package).name in _READ:
        return True
    return any(kind_of_model(document, one) in MONITORED for one in package.iter())


def _class_of(document: EddiDocument, element: Element) -> str:
    """Return the class that an element states, else the feature that it is in."""
    return document.class_of(element).printed or feature_of(element)


def _not_read(document: EddiDocument, stated: str, same: Sequence[Element]) -> Problem:
    count = sum(1 for one in same for _ in one.iter())
    elements = f"{count} element{'s' if count != 1 else ''}"
    name = local_name(stated)
    what = elements if name == stated else f"{stated}, {elements}"
    is_one = len(same) == 1
    verb, them = ("is", "it") if is_one else ("are", "them")
    message = f"{len(same)} {name} ({what}) {verb} not read: no monitor is made of {them}"
    return warning("X021", message, document.place(same[0]))
