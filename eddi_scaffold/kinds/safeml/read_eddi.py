"""SafeML settings in an EDDI: a map ``eddi.safeml`` with the keys of a SafeML configuration.

The values become the lines of such a configuration, which is read as one.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from eddi_scaffold.common.files import PartSource, Source
from eddi_scaffold.common.problems import Place, Problem, did_you_mean, has_errors, problem
from eddi_scaffold.eddi_xml.extensions import (
    MODEL,
    SAFEML,
    ExtensionMap,
    extension_maps,
    unknown_tags,
)
from eddi_scaffold.eddi_xml.parsing import select
from eddi_scaffold.kinds.safeml.reference import read_named
from eddi_scaffold.kinds.safeml.scope import SafeMLFile, SafeMLSettings
from eddi_scaffold.kinds.safeml.settings import KEYS, export, read_settings

if TYPE_CHECKING:
    from eddi_scaffold.eddi_xml.document import EddiDocument


DIGEST, ARTIFACT = "reference_sample_sha256", "artifact"
_REFERENCE = "reference_sample_file"
_PLAIN = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.+-]*", re.ASCII)


def read_eddi(
    document: EddiDocument, source: Source
) -> tuple[list[tuple[ExtensionMap, Source, SafeMLFile]], list[Problem]]:
    """Read the SafeML monitors of an EDDI, and the references that they name."""
    files: list[tuple[ExtensionMap, Source, SafeMLFile]] = []
    problems: list[Problem] = []
    for extension_map in extension_maps(document, SAFEML):
        known = (MODEL, *KEYS, DIGEST, ARTIFACT)
        wrong = [*unknown_tags(extension_map, known, known), *_artifacts(extension_map, document)]
        if extension_map.model is None or has_errors(wrong):
            problems += wrong
            continue
        text, settings, more = _settings(extension_map, source.name)
        wrong += more
        if settings is not None:
            reference, more = read_named(source.name, settings)
            wrong += more
            if reference is not None:
                wrong += _digest(extension_map, reference.source)
                if not has_errors(wrong):
                    part = PartSource(source, text.encode())
                    files.append((extension_map, part, SafeMLFile(settings, reference)))
        problems += wrong
    return files, problems


def as_eddi_map(name: str, file: SafeMLFile) -> tuple[str, Sequence[tuple[str, str]]]:
    """Return the map that holds the settings, with the digest of their reference."""
    (text, _) = export(file, name, file.settings.reference_sample_file).values()
    pairs = [line.partition(": ")[::2] for line in text.splitlines()]
    values = [(key, value) for key, value in pairs if value != "null"]
    return SAFEML, [(MODEL, name), *values, (DIGEST, file.reference.source.sha256)]


def _settings(
    extension_map: ExtensionMap, name: str
) -> tuple[str, SafeMLSettings | None, list[Problem]]:
    """Read the values as a configuration whose lines they are."""
    values = extension_map.of(*KEYS)
    text = "".join(f"{value.tag}: {_scalar(value.text)}\n" for value in values)
    settings, problems = read_settings(Source(name, (text or "{}").encode()))

    def placed(place: Place) -> Place:
        inside = 0 < (place.line or 0) <= len(values) and place != Place(name, 1, 1)
        return values[(place.line or 1) - 1].place if inside else extension_map.place

    problems = [replace(problem, place=placed(problem.place), excerpt=None) for problem in problems]
    if settings is not None:
        places = {value.tag: value.place for value in values}
        settings = replace(settings, places={"": extension_map.place, **places})
    return text, settings, problems


def _scalar(text: str) -> str:
    """Return a value as YAML: a number or a word as it is, all else in quotes."""
    return text if _PLAIN.fullmatch(text) else json.dumps(text)


def _digest(extension_map: ExtensionMap, reference: Source) -> Iterator[Problem]:
    for value in extension_map.of(DIGEST):
        if value.text.lower() != reference.sha256:
            yield problem("L004.digest", value.place, sha256=reference.sha256, expected=value.text)


def _artifacts(extension_map: ExtensionMap, document: EddiDocument) -> Iterator[Problem]:
    for value in extension_map.of(ARTIFACT):
        gids = [str(gid) for root in document.roots for gid in select(root, ".//@gid")]
        if value.text not in gids:
            yield problem(
                "L004.gid", value.place, hint=did_you_mean(value.text, gids), gid=value.text
            )
