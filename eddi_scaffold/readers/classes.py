"""Classes of the metamodel, to find the misspelt one: what is of no known class is not read.

Only the contents of packages are inspected. Files of other tools hold many more classes than a
monitor is made of; these are not reported.
"""

from __future__ import annotations

from collections.abc import Iterator
from difflib import SequenceMatcher
from typing import TYPE_CHECKING

from eddi_scaffold.problems import Problem, warning
from eddi_scaffold.readers.spelling import fold, local_name
from eddi_scaffold.readers.survey import MONITORED, kind_of_model
from eddi_scaffold.readers.xmi import XSI_TYPE, feature_of

if TYPE_CHECKING:
    from eddi_scaffold.readers.document import EddiDocument

MODELS = ("BayesianNetwork", "ConSert", "FaultTree", "MarkovChain")
"""Classes that monitors are made of."""
PACKAGES = ("ConSertPackage", "DDIPackage", "FailureLogicPackage")
"""Packages that hold them."""
OTHERS = (
    *("AttackTree", "Failure", "FailureModel", "FMEA", "FMEDA", "SecurityViolation"),
    *("AssuranceCasePackage", "ArgumentPackage", "ArtifactPackage", "TerminologyPackage"),
    *("ArchitecturePackage", "DesignPackage", "DependabilityPackage", "RequirementPackage"),
    *("DomainPackage", "HARAPackage", "TARAPackage", "StandardPackage", "ODEProductPackage"),
    *("System", "PhysicalComponent", "LogicalComponent", "SoftwareComponent", "Function"),
)
"""Classes of the metamodel that are left out on purpose."""

CLASSES = frozenset(fold(name) for name in (*MODELS, *PACKAGES, *OTHERS))
"""All that are known, folded."""
_RUN = frozenset({"failurelogic", "bayesiannetwork"})
"""Packages of which every class should be known."""
_NEAR = 0.8


def unknown_classes(document: EddiDocument) -> Iterator[Problem]:
    """Yield a warning (X015) for each element of a package whose class looks like a misspelt one.

    In the packages that hold chains, trees and networks every unknown class is named.
    """
    for package in document.packages():
        if kind_of_model(document, package) in MONITORED:
            continue  # the root is a model, whose reader knows its parts
        for element in package.iterchildren():
            if element.get(XSI_TYPE) is None:
                continue
            kind = document.class_of(element)
            if kind.name in CLASSES:
                continue
            meant = _nearest(local_name(kind.printed))
            if meant is None and (kind.package not in _RUN or kind.name.endswith("package")):
                continue
            name = element.get("name")
            what = feature_of(element) + (f' "{name}"' if name else "")
            message = f'{what} is of the unknown class "{kind.printed}"'
            if not any(kind_of_model(document, one) in MONITORED for one in element.iter()):
                message += ", so that nothing is read from it"
            hint = f"did you mean {meant!r}?" if meant else f"known are: {', '.join(MODELS)}"
            yield warning("X015", message, document.place(element), hint)


def _nearest(name: str) -> str | None:
    folded = fold(name)
    likeness = {
        known: SequenceMatcher(None, folded, fold(known)).ratio() for known in (*MODELS, *PACKAGES)
    }
    best = max(likeness, key=likeness.__getitem__)
    return best if likeness[best] >= _NEAR else None
