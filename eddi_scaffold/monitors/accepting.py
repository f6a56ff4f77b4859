"""What the configuration of an input accepts in place of a value that somebody vouches for.

The same list goes two ways: ``check``, ``show`` and ``trace`` name the claims that rest on it, and
the monitor reports at run time which are in use.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

from eddi_runtime.inputs import UNSAFE_DEFAULT

from eddi_scaffold.claims import Acceptance
from eddi_scaffold.config.schema import InputEntry
from eddi_scaffold.language.uses import accepted, lasts

_LIMITLESS = "max_age: none"


def of_input(entry: InputEntry, spec: Mapping[str, Any], index: int) -> Iterator[Acceptance]:
    """Return what an entry of ``EDDIInputs`` accepts.

    Args:
        entry: as it is configured.
        spec: the same in ``config/model.json``.
        index: of the entry.
    """
    path = ("EDDIInputs", index)
    if spec["max_age"] == "none":
        yield Acceptance(_LIMITLESS, "the last value", input=entry.id, path=(*path, "max_age"))
    if entry.allow_unsafe_default and entry.default not in (None, False):
        text, key = f"the default {entry.default!r}", UNSAFE_DEFAULT.partition(":")[0]
        until = "until the first message"
        yield Acceptance(UNSAFE_DEFAULT, text, until, input=entry.id, path=(*path, key))
    computed = spec.get("expression")
    key = "expression" if entry.expression is not None else "expression_file"
    for part in computed["parts"] if computed is not None else ():
        (output,) = part["form"]["outputs"]
        for one in accepted(part["form"], output["node"]):
            found = Acceptance(one.word, one.accepts, lasts(one), one.seconds, path=(*path, key))
            yield replace(found, input=entry.id)


def keys(entry: InputEntry, spec: Mapping[str, Any]) -> list[str]:
    """Return the keys of an entry that the runtime cannot see in its other fields."""
    found = (one.key for one in of_input(entry, spec, 0))
    return list(dict.fromkeys(key for key in found if key != _LIMITLESS))
