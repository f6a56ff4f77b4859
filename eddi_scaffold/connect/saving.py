"""A configuration before and after: read and compared."""

from __future__ import annotations

import difflib
import os
from dataclasses import dataclass
from pathlib import Path

from eddi_scaffold.common.files import read_source
from eddi_scaffold.config.topic_block import ConfigText, read_block


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
