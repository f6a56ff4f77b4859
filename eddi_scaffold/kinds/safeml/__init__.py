"""The kind ``safeml``: does what a perception component sees still look like its reference?

SESAME D7.2 section 3.4. The statistics are those of the literature, not the sums of the SafeML
library, whose distribution nobody knows.
"""

from __future__ import annotations

import importlib
import re
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from eddi_scaffold.kinds import Kind, Reading, with_status
from eddi_scaffold.kinds.safeml.claims import MEANINGS, limits, support
from eddi_scaffold.kinds.safeml.messages import MESSAGES

if TYPE_CHECKING:
    from eddi_scaffold.readers.document import EddiDocument
    from eddi_scaffold.source import Source

_SUFFIXES = (".yml", ".yaml")
_OWN_KEY = re.compile(
    rb"""(?m)^(?:\{\s*)?["']?(?:window_size|reference_sample_file|distance_metric)["']?\s*:"""
)


def _later(name: str) -> Callable[..., Any]:
    """Return a function of the kind; numpy, which it needs, is imported when it is called."""

    def call(*values: Any) -> Any:
        functions = importlib.import_module(f"{__name__}.functions")
        return getattr(functions, name)(*values)

    return call


def _sniff(source: Source) -> bool:
    return source.name.lower().endswith(_SUFFIXES) and _OWN_KEY.search(source.data) is not None


def _read_eddi(_document: EddiDocument, _source: Source, _marks: Sequence[str]) -> Reading:
    """An EDDI holds no reference samples."""
    return Reading((), ())


KIND = Kind(
    name="safeml",
    title="SafeML",
    config_types=("SafeML",),
    read_eddi=_read_eddi,
    sniff=_sniff,
    read_file=_later("read_file"),
    check=_later("check"),
    counts=_later("counts"),
    outline=_later("outline"),
    export=_later("export"),
    inputs=_later("inputs"),
    runtime_model=_later("model_part"),
    messages=MESSAGES,
    output_message="SafeMLOutput",
    beside=with_status("SafeMLStatus"),
    configure=_later("configure"),
    settings=_later("settings"),
    requirements=("numpy",),
    data_files=_later("data_files"),
    readme=_later("readme"),
    diagram=_later("diagram"),
    named_by_config=True,
    limits=limits,
    support=support,
    meanings=lambda _document, _part: MEANINGS,
)
"""What the generator knows of SafeML."""
