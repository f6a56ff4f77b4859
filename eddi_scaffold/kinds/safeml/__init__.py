"""The kind ``safeml``: does what a perception component sees still look like its reference?

SESAME D7.2 section 3.4. The statistics are those of the literature, not the sums of the SafeML
library, whose distribution is not known.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from eddi_scaffold.kinds import Kind
from eddi_scaffold.kinds.safeml.messages import MESSAGES, VERDICTS, VIOLATION_FIELD, respelt

if TYPE_CHECKING:
    from eddi_scaffold.common.files import Source

_SUFFIXES = (".yml", ".yaml")
_OWN_KEY = re.compile(
    rb"""(?m)^(?:\{\s*)?["']?(?:window_size|reference_sample_file|distance_metric)["']?\s*:"""
)


def _recognises(source: Source) -> bool:
    return source.name.lower().endswith(_SUFFIXES) and _OWN_KEY.search(source.data) is not None


KIND = Kind(
    name="safeml",
    title="SafeML",
    config_types=("SafeML",),
    recognises=_recognises,
    messages=MESSAGES,
    output_message="SafeMLOutput",
    options=(VIOLATION_FIELD,),
    respelt=respelt,
    verdicts=VERDICTS,
    model="safeml_model.SafeMLModel",
    topic="safeml",
    in_eddi='descendant-or-self::*[local-name()="keyValueMaps"][@key="eddi.safeml"]',
    requirements=("numpy",),
    named_by_config=True,
)
"""What the generator knows of SafeML."""
