"""SafeML settings in an EDDI: a map ``eddi.safeml`` with the keys of a SafeML configuration.

The values become the lines of such a configuration, which is read as one.
"""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from eddi_scaffold.common.files import Source
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
from eddi_scaffold.kinds.safeml.scope import SafeMLFile
from eddi_scaffold.kinds.safeml.settings import KEYS, export, read_settings

if TYPE_CHECKING:
    from eddi_scaffold.eddi_xml.document import EddiDocument

DIGEST, ARTIFACT = "reference_sample_sha256", "artifact"
_KNOWN = (MODEL, *KEYS, DIGEST, ARTIFACT)
_PLAIN = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.+-]*", re.ASCII)


def read_eddi(
    document: EddiDocument, source: Source
) -> tuple[list[tuple[ExtensionMap, Source, SafeMLFile]], list[Problem]]:
    """Read the SafeML monitors of an EDDI, and the references that they name."""
    files: list[tuple[ExtensionMap, Source, SafeMLFile]] = []
    problems: list[Problem] = []
    gids = [str(gid) for root in document.roots for gid in select(root, ".//@gid")]
    for extension_map in extension_maps(document, SAFEML):
        faults = [*unknown_tags(extension_map, _KNOWN, _KNOWN)]
        for value in extension_map.of(ARTIFACT):
            if value.text not in gids:
                hint = did_you_mean(value.text, gids)
                faults.append(problem("L004.gid", value.place, hint=hint, gid=value.text))
        if extension_map.model is not None and not has_errors(faults):
            file, text, more = _file(extension_map, source.name)
            faults += more
            if file is not None and not has_errors(faults):
                files.append((extension_map, replace(source, part=text.encode()), file))
        problems += faults
    return files, problems


def as_eddi_map(name: str, file: SafeMLFile) -> tuple[str, Sequence[tuple[str, str]]]:
    """Return the map that holds the settings, with the digest of their reference."""
    (text, _) = export(file, name, file.settings.reference_sample_file).values()
    pairs = [line.partition(": ")[::2] for line in text.splitlines()]
    values = [(key, value) for key, value in pairs if value != "null"]
    return SAFEML, [(MODEL, name), *values, (DIGEST, file.reference.source.sha256)]


def _file(extension_map: ExtensionMap, name: str) -> tuple[SafeMLFile | None, str, list[Problem]]:
    """Read the values as a configuration whose lines they are: words as they are, or in quotes."""
    values = extension_map.of(*KEYS)
    texts = [v.text if _PLAIN.fullmatch(v.text) else json.dumps(v.text) for v in values]
    lines = [f"{value.tag}: {text}\n" for value, text in zip(values, texts, strict=True)]
    text = "".join(lines)
    settings, problems = read_settings(Source(name, (text or "{}").encode()))

    def placed(place: Place) -> Place:
        inside = 0 < (place.line or 0) <= len(values) and place != Place(name, 1, 1)
        return values[(place.line or 1) - 1].place if inside else extension_map.place

    problems = [replace(problem, place=placed(problem.place), excerpt=None) for problem in problems]
    if settings is None:
        return None, text, problems
    places = {value.tag: value.place for value in values}
    settings = replace(settings, places={"": extension_map.place, **places})
    reference, more = read_named(name, settings)
    problems += more
    if reference is None:
        return None, text, problems
    sha256 = reference.source.sha256
    problems += [
        problem("L004.digest", value.place, sha256=sha256, expected=value.text)
        for value in extension_map.of(DIGEST)
        if value.text.lower() != sha256
    ]
    return SafeMLFile(settings, reference), text, problems
