"""Names of elements, attributes and classes, compared the way that real files need it.

Namespace URIs, prefixes, trailing underscores and the case of letters differ between the tools
that write EDDIs, so names are compared folded. The scanned text of SESAME D7.2 prints "ConSert"
as "Consent" in many places, and users copy from it: folding undoes that too.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cached_property, lru_cache

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


def is_misprint(name: str) -> bool:
    """Return whether folding had to repair more than underscores and case."""
    return fold(name) != name.strip("_").casefold()


@dataclass(frozen=True)
class Spelling:
    """A name of the metamodel.

    Attributes:
        name: the name that we write.
        also: other names that are read without a word.
    """

    name: str
    also: tuple[str, ...] = ()

    @cached_property
    def folded(self) -> frozenset[str]:
        """All accepted names, folded."""
        return frozenset(fold(name) for name in (self.name, *self.also))

    def accepts(self, name: str) -> bool:
        """Return whether a printed name means this one."""
        return fold(name) in self.folded

    def is_exact(self, name: str) -> bool:
        """Return whether a printed name is one of the accepted ones, letter by letter."""
        return name == self.name or name in self.also


@dataclass(frozen=True)
class ClassName:
    """The class of an object: package key and name, both folded.

    Attributes:
        package: last segment of the namespace URI (``failurelogic``), empty when unknown.
        name: class name (``faulttree``), empty when the element does not give it.
        printed: as the file has it, for messages.
    """

    package: str = ""
    name: str = ""
    printed: str = ""


def package_key(uri_or_prefix: str) -> str:
    """Return the package key of a namespace: URIs of all generations give the same key."""
    return fold(re.split(r"[/#]", uri_or_prefix.rstrip("/#"))[-1])
