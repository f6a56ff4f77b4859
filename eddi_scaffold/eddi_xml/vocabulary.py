"""Names of the metamodel in EDDI XML with their spellings: the place to change."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path

from eddi_scaffold.common.toml_tables import read_toml

_MISPRINTS = (("consent", "consert"), ("odipackage", "ddipackage"), ("allinonepkg", "allinone"))


@lru_cache(maxsize=4096)
def fold(name: str) -> str:
    """Return the form in which names are compared: no outer ``_``, no case, no known misprint."""
    folded = name.strip("_").casefold()
    for printed, intended in _MISPRINTS:
        folded = folded.replace(printed, intended)
    return folded


@lru_cache(maxsize=4096)
def local_name(tag: str) -> str:
    """Return a tag or attribute name without its namespace (``{uri}name`` or ``prefix:name``)."""
    return re.split(r"[}:]", tag)[-1]


@dataclass(frozen=True)
class Spelling:
    """A name of the metamodel."""

    name: str  # the name that we write
    also: tuple[str, ...] = ()  # other names that are read without a word

    @cached_property
    def folded(self) -> frozenset[str]:
        """All accepted names, folded."""
        return frozenset(fold(name) for name in (self.name, *self.also))

    def accepts(self, name: str) -> bool:
        """Return whether a printed name means this one."""
        return fold(name) in self.folded


@dataclass(frozen=True)
class ClassName:
    """The class of an object: package key and name, both folded."""

    package: str = ""  # last segment of the namespace URI (`failurelogic`), empty when unknown
    name: str = ""  # class name (`faulttree`), empty when the element does not give it
    printed: str = ""  # as the file has it, for messages


def package_key(uri_or_prefix: str) -> str:
    """Return the package key of a namespace: URIs of all generations give the same key."""
    return fold(re.split(r"[/#]", uri_or_prefix.rstrip("/#"))[-1])


PACKAGE_CLASS = "consertpackage"

METAMODEL = read_toml(Path(__file__).with_name("metamodel.toml"))
_SPELLINGS = {
    key: Spelling(name, tuple(also))
    for key, (name, *also) in ((k, text.split()) for k, text in METAMODEL["spellings"].items())
}
_ROLES = {role: text.split() for role, text in METAMODEL["roles"].items()}


def __getattr__(name: str) -> Spelling:
    """Return a name of the metamodel: ``vocabulary.GUARANTEES``."""
    if name not in _SPELLINGS:
        raise AttributeError(name)
    return _SPELLINGS[name]


LINKS = frozenset(map(fold, _ROLES["links"]))  # features that refer to what no monitor needs
# features of models that refer to other elements where they are attributes
REFERENCES = LINKS.union(*(_SPELLINGS[name].folded for name in _ROLES["references"]))
# attributes -> what several of them say
ONE_THING = {
    name: _SPELLINGS[key].name for key in _ROLES["one_thing"] for name in _SPELLINGS[key].folded
} | {fold(_SPELLINGS["PUBLIC_UNIT"].name): _SPELLINGS["UNIT"].name}

NETWORKS = (
    'descendant-or-self::*[contains(local-name(), "ayesianNetwork") or '
    '@*[local-name() = "type" and contains(., "ayesianNetwork")]]'
)
"""XPath below a root: Bayesian networks."""

_LOWER = 'translate({0}, "FAULTREMKOVCHINS", "faultremkovchins")'


def _of_classes(*classes: str) -> str:
    holds = " or ".join(f'contains({_LOWER}, "{name}")' for name in classes)
    return (
        f"self::*[{holds.format('local-name()')}] | "
        f'descendant-or-self::*[@*[local-name() = "type" and ({holds.format(".")})]]'
    )


MACHINES = _of_classes("statemachine")
"""XPath at a root: state machines; classes are compared without case."""
CHAINS_AND_TREES = _of_classes("faulttree", "markovchain", "statemachine")
"""XPath at a root: chains, trees and state machines."""
