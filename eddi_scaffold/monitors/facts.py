"""What a package remembers of its monitor: for wiring, tracing and status, small and typed."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from functools import cache

from pydantic import TypeAdapter

from eddi_scaffold.common.claims import Acceptance, Claim, Element
from eddi_scaffold.eddi_xml.links import Linked

FORMAT = 1


@dataclass(frozen=True)
class InputFacts:
    """One input of a monitor."""

    id: str
    attribute: str  # its name in `EDDIInput`
    requires: tuple[str, ...] = ()  # ids of the simulator outputs that it is made of
    max_age: float | str | None = None  # as `InputBinding` has it
    # seconds after which its kind or its expression takes it as unknown
    timeout_s: float | None = None
    every_message: bool = False  # no message is skipped
    reads: tuple[str, ...] | None = None  # names that its expression reads; `None` without one


@dataclass(frozen=True)
class MonitorFacts:
    """Content of the answer ``facts_json``."""

    kind: str
    id: str
    digest: str  # of all that decides what the monitor computes; robots compare it
    file: str
    file_sha256: str
    inputs: tuple[InputFacts, ...]  # in the order of the configuration
    path: str | None = None  # EMF fragment path of the model in an EDDI
    claims: tuple[Claim, ...] = ()
    acceptances: tuple[Acceptance, ...] = ()  # what it accepts in place of what is not known
    elements: tuple[Element, ...] = ()  # in the order of the model
    # path of an element -> what is linked with it in the EDDI
    links: dict[str, Linked] | None = None
    format: int = FORMAT

    def claims_on(self, part: str | None) -> list[Claim]:
        """Return the claims on a topic that carries one of them, or all."""
        return [claim for claim in self.claims if part in (None, claim.id)]

    def to_json(self) -> str:
        """Return the text of the answer."""
        content = asdict(self, dict_factory=lambda pairs: {k: v for k, v in pairs if v is not None})
        return json.dumps(content, sort_keys=True, indent=1, default=sorted)


def from_json(text: object) -> MonitorFacts:
    """Return the facts of a package.

    Raises:
        ValueError: the text is damaged, or of another format.
    """
    if not isinstance(text, str):
        raise ValueError("there are no facts of the monitor")  # noqa: TRY004 - damage, no misuse
    facts = _adapter().validate_json(text)
    if facts.format != FORMAT:
        raise ValueError(f"facts of the format {facts.format}, only {FORMAT} is known")
    return facts


@cache
def _adapter() -> TypeAdapter[MonitorFacts]:
    return TypeAdapter(MonitorFacts)
