"""A configuration before and after: read, compared, replaced as one step."""

from __future__ import annotations

import difflib
import os
from dataclasses import dataclass
from pathlib import Path

from eddi_scaffold.common.files import read_source, saved_meanwhile
from eddi_scaffold.config.topic_block import ConfigText, read_block
from eddi_scaffold.packages.transaction import NEW, FileState, write

_MARK = b"\xef\xbb\xbf"


def read_config_text(path: Path | None, name: Path) -> tuple[ConfigText, str | None]:
    """Return a configuration and its text, ``None`` as the text where there is no file."""
    if path is None or not (path.exists() or path.is_symlink()):
        return ConfigText(str(name), ""), None
    document = read_block(read_source(path))
    return document, document.text


@dataclass(frozen=True)
class ConfigChange:
    """What a configuration becomes."""

    name: str  # of the file
    before: str | None  # its text, `None` when there is no file
    after: str  # its new text; the old one where there are errors and nothing resolved

    @property
    def is_changed(self) -> bool:
        """Whether there is something to write."""
        return self.after != (self.before or "")

    def diff(self) -> str:
        """Return the change as a unified diff."""
        old, new = (t.splitlines(keepends=True) for t in (self.before or "", self.after))
        former = self.name if self.before is not None else os.devnull
        lines = difflib.unified_diff([*old], [*new], former, self.name)
        return "".join(line if line.endswith("\n") else f"{line}\n" for line in lines)

    def save(self) -> None:
        """Replace the file as one step; its byte order mark and its mode stay.

        Raises:
            EddiError: it cannot be written (F002), or was saved meanwhile (F013); it stays as it
                is.
        """
        target = Path(self.name).resolve()
        old = target.read_bytes() if target.exists() else None
        if old is not None and self.before is None:
            raise saved_meanwhile(Path(self.name))
        mark = _MARK if old is not None and old.startswith(_MARK) else b""
        mode = NEW if old is None else target.stat().st_mode & 0o7777
        before = {} if self.before is None else {target.name: mark + self.before.encode()}
        new = FileState(mark + self.after.encode(), mode)
        write(target.parent, {target.name: new}, before)
