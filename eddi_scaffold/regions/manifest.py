"""The manifest of a package: digests by which text of ours is told from a person's."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

from .bases import read_bases
from .conflicts import both_sides
from .files import read_regular
from .formatting import meaning_digest
from .paths import inside
from .store import EDDI, files_below, read_text, write_file

MANIFEST = "manifest.json"
ANSWERS = ".copier-answers.yml"
"""File of a package in which Copier keeps the answers."""
OF_TWO_BRANCHES = "of two branches"
"""In place of a digest of a rendering: no package has it."""
_LAYOUT = b" \t\r\n'\"(),\\"
_LOWER = bytes(range(256)).lower()
"""With these characters and upper case formatters do what they do, in every version of Python."""


@dataclass(frozen=True)
class Digests:
    """What is recorded of a rendering: the SHA-256 of its bytes and, of Python, of its meaning."""

    sha256: str
    meaning: str | None = None

    def fit(self, name: str, data: bytes) -> bool:
        """Return whether a text is this rendering, but for line ends and the layout of Python."""
        if self.sha256 == _sha256(data):
            return True
        plain = data.replace(b"\r\n", b"\n")
        return self.sha256 == _sha256(plain) or (
            self.meaning is not None and self.meaning == _meaning(name, plain)
        )


def digests_of(name: str, data: bytes, known: Digests | None = None) -> Digests:
    """Return what is recorded of a rendering.

    Args:
        name: the file.
        data: its bytes.
        known: digests of a former rendering: if it was the same, that of Python is known.
    """
    digest = _sha256(data)
    if known is not None and known.meaning and known.sha256 == digest:
        return known
    return Digests(digest, _meaning(name, data))


def recorded_files(root: Path) -> dict[str, Digests]:
    """Return the digests of the generated-only files of the last finished rendering."""
    return {name: one for name, one in _files(_manifest(root)).items() if inside(root, name)}


def record_files(root: Path, written: Mapping[str, Digests]) -> None:
    """Record what was written of them, and what the whole package was made of."""
    record = {
        "meaning": {name: one.meaning for name, one in written.items() if one.meaning is not None},
        "rendering": rendering_digest(root),
        "sha256": {name: one.sha256 for name, one in written.items()},
    }
    _write(root, {**_manifest(root), **record})


def changed_bases(root: Path) -> list[str]:
    """Return the files whose base is not what was recorded: generated and own text look alike.

    Not those of a run that was killed, of which base and record may differ; none without a record.
    """
    recorded, there = _bases(root), read_bases(root)
    under_way = files_below(root / EDDI / "next")
    # names are in the record, too, where something was replaced; of a file left alone it has none
    unknown = None if recorded.keys() <= there.keys() else Digests("")
    return [
        name
        for name, text in sorted(there.items() if recorded else ())
        if name not in under_way
        and (was := recorded.get(name, unknown)) is not None
        and not was.fit(name, text.encode())
    ]


def record_bases(root: Path, made: Mapping[str, str | None]) -> None:
    """Record digests of the bases that were written; of other files they stay as they are.

    Args:
        root: the package.
        made: file -> its base, ``None`` where it has none any more.
    """
    before, there = _bases(root), read_bases(root)
    now = {name: one for name, one in before.items() if name in there}
    for name, text in made.items():
        if text is not None:
            now[name] = digests_of(name, text.encode(), before.get(name))
    if now != before:
        bases = {name: one and _without_none(asdict(one)) for name, one in now.items()}
        _write(root, {**_manifest(root), "base": bases})


def is_of_old_layout(root: Path) -> bool:
    """Return whether Copier itself rendered all files of the package, as up to version 0.1."""
    return "meaning" not in _manifest(root)


def rendering_digest(root: Path) -> str:
    """Return the SHA-256 of a package's answers and of the renderings that its files were made of.

    Without where the templates lie, and without what a formatter changes.
    """
    text = read_text(root / ANSWERS)
    kept, origin = [], False
    for line in (text if isinstance(text, str) else "").split("\n"):
        origin = line.startswith("_src_path") or (origin and line[:1] in {" ", "\r", ""})
        if not origin:
            kept.append(line)
    digest = hashlib.sha256("\n".join(kept).encode().translate(_LOWER, _LAYOUT))
    for name, base in sorted(read_bases(root).items()):
        data = base.encode()
        digest.update(b"\0" + os.fsencode(name) + b"\0" + data.translate(_LOWER, _LAYOUT))
    return digest.hexdigest()


def recorded_rendering(root: Path) -> str:
    """Return the same of the last finished rendering, empty without one."""
    return str(_manifest(root).get("rendering") or "")


def _bases(root: Path) -> dict[str, Digests | None]:
    """Return the digests of the bases, ``None`` of one that was merged from two branches."""
    return {
        name: Digests(str(one.get("sha256")), one.get("meaning") and str(one["meaning"]))
        if isinstance(one, dict)
        else None
        for name, one in _part(_manifest(root), "base").items()
    }


def _files(record: Mapping[str, object]) -> dict[str, Digests]:
    texts, meanings = (_part(record, key) for key in ("sha256", "meaning"))
    return {
        name: Digests(str(digest), str(meanings[name]) if name in meanings else None)
        for name, digest in texts.items()
    }


def _part(record: Mapping[str, object], key: str) -> dict[str, object]:
    part = record.get(key)
    return part if isinstance(part, dict) else {}


def _without_none(record: Mapping[str, object]) -> dict[str, object]:
    return {key: value for key, value in record.items() if value is not None}


def _meaning(name: str, data: bytes) -> str | None:
    return meaning_digest(data) if name.endswith(".py") else None


def _sha256(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


def _manifest(root: Path) -> dict[str, object]:
    text = read_text(root / EDDI / MANIFEST)
    try:
        sides = dict.fromkeys(both_sides(text)) if isinstance(text, str) else ()
        found = [json.loads(side) for side in sides]
    except (ValueError, RecursionError):
        return {}
    if not found or not all(isinstance(one, dict) for one in found):
        return {}
    return found[0] if len(found) == 1 else _of_two_branches(root, *found)


def _of_two_branches(
    root: Path, ours: Mapping[str, object], theirs: Mapping[str, object]
) -> dict[str, object]:
    """Return the record of a merge in conflict: that of the branch which each file is of."""
    mine, other = _files(ours), _files(theirs)
    files = {**mine, **{n: one for n, one in other.items() if n not in mine or _fits(root, n, one)}}
    bases, others = (_part(one, "base") for one in (ours, theirs))
    return {
        "base": {name: one if others.get(name) == one else None for name, one in bases.items()},
        "meaning": {name: one.meaning for name, one in files.items() if one.meaning is not None},
        "rendering": OF_TWO_BRANCHES,
        "sha256": {name: one.sha256 for name, one in files.items()},
    }


def _fits(root: Path, name: str, record: Digests) -> bool:
    try:
        return inside(root, name) is not None and record.fit(name, read_regular(root / name))
    except OSError:
        return False


def _write(root: Path, record: Mapping[str, object]) -> None:
    text = json.dumps(record, indent=1, sort_keys=True) + "\n"
    write_file(root, f"{EDDI}/{MANIFEST}", text.encode())
