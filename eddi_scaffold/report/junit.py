"""Results of tests as JUnit XML, which servers for continuous integration read."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from eddi_scaffold.common.escaping import one_line


class Case(NamedTuple):
    """A test, or what no test covers."""

    of: str  # monitor and guarantee
    name: str
    failure: str = ""
    not_covered: str = ""  # why there is no test


def junit(suites: Mapping[str, tuple[Mapping[str, str], Sequence[Case]]]) -> str:
    """Return a suite for each monitor, of its properties (digests) and cases."""
    root = Element("testsuites")
    for name, (properties, cases) in suites.items():
        counts = {
            "tests": len(cases),
            "failures": sum(bool(case.failure) for case in cases),
            "errors": 0,
            "skipped": sum(bool(case.not_covered) for case in cases),
        }
        numbers = {key: str(count) for key, count in counts.items()}
        suite = SubElement(root, "testsuite", {"name": name, **numbers})
        about = SubElement(suite, "properties")
        for key, value in properties.items():
            SubElement(about, "property", {"name": key, "value": value})
        for case in cases:
            element = SubElement(
                suite, "testcase", {"classname": one_line(case.of), "name": one_line(case.name)}
            )
            for tag, message in (("failure", case.failure), ("skipped", case.not_covered)):
                if message:
                    SubElement(element, tag, {"message": one_line(message)})
    indent(root)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{tostring(root, encoding="unicode")}\n'
