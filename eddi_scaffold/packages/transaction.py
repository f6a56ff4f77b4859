"""Write the output files of a command: all staged first, so that a full disk changes nothing."""

from __future__ import annotations

import codecs
import secrets
import shutil
from collections.abc import Mapping
from pathlib import Path

from eddi_scaffold.common.files import refuse_input, saved_meanwhile
from eddi_scaffold.common.problems import EddiError, Place, problem
from eddi_scaffold.config.topic_block import ConfigText
from eddi_scaffold.regions.package import Step, obstacle, put_aside


def write(
    root: Path,
    files: Mapping[str, bytes],
    before: Mapping[str, bytes] | None = None,
) -> None:
    """Write files below ``root``; with a problem, none. The mode of one that is there stays.

    ``before``: path -> the bytes that the new ones were made from.

    Raises:
        EddiError: nothing could be written (F002), a file was saved meanwhile (F013), or a file
            of which no ``before`` is given is an input of the command (F014).
    """
    read = before or {}
    for path in files.keys() - read.keys():
        refuse_input(root / path)
    for path in files:
        if reason := obstacle(root, path):
            raise EddiError(problem("F002.write", Place(str(root / path)), reason=reason))
    staging = root / f".eddi-{secrets.token_hex(4)}"
    try:
        root.mkdir(parents=True, exist_ok=True)
        steps = []
        for path, data in files.items():
            there = (root / path).is_file()
            mode = (root / path).stat().st_mode & 0o7777 if there else 0o644
            steps.append(Step(path, data, mode))
        put_aside(root, steps, staging)
        for path, data in read.items():
            if (root / path).read_bytes() != data:
                raise saved_meanwhile(root / path)
        for number, path in enumerate(files):
            (root / path).parent.mkdir(parents=True, exist_ok=True)
            (staging / str(number)).replace(root / path)
    except OSError as failure:
        reason = failure.strerror or str(failure)
        named = failure.filename is not None and str(staging) not in str(failure.filename)
        place = Place(str(failure.filename if named else root))
        raise EddiError(problem("F002.write", place, reason=reason)) from None
    finally:
        shutil.rmtree(staging, ignore_errors=True)


def rewrite(document: ConfigText, after: str) -> None:
    """Replace a configuration, or write one that is new; its byte order mark and mode stay.

    Raises:
        EddiError: it cannot be written (F002), or was saved meanwhile (F013); it stays as it is.
    """
    target = Path(document.name).resolve()
    old = target.read_bytes() if target.exists() else None
    if old is not None and document.is_new:
        raise saved_meanwhile(Path(document.name))
    mark = codecs.BOM_UTF8 if old is not None and old.startswith(codecs.BOM_UTF8) else b""
    former = {} if document.is_new else {target.name: mark + document.text.encode()}
    write(target.parent, {target.name: mark + after.encode()}, former)
