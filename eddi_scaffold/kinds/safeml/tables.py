"""Tables of numbers in a package: in the model where they are few, else in a file of doubles."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass

from eddi_scaffold.kinds import JsonValue
from eddi_scaffold.kinds.safeml.design import Rows

MOST_IN_TEXT = 2000
"""Numbers of a table that a person may still want to look at."""


@dataclass(frozen=True, eq=False)
class Table:
    """A table of a package.

    Attributes:
        file: name of its file, which is there if the numbers are too many for a text.
        numbers: (rows, columns).
    """

    file: str
    numbers: Rows

    @property
    def files(self) -> dict[str, bytes]:
        """Return the file, if there is one: doubles, least significant byte first, row by row."""
        if self.numbers.size <= MOST_IN_TEXT:
            return {}
        return {self.file: self.numbers.astype("<f8").tobytes()}

    def as_json(self) -> JsonValue:
        """Return the numbers, or which file has them."""
        if self.numbers.size <= MOST_IN_TEXT:
            rows: JsonValue = self.numbers.tolist()
            return rows
        digest = hashlib.sha256(self.files[self.file]).hexdigest()
        return {"file": self.file, "sha256": digest, "shape": list(self.numbers.shape)}
