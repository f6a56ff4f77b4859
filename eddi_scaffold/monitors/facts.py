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
    """One input of a monitor.

    Attributes:
        id: as in the model.
        attribute: its name in ``EDDIInput``.
        requires: ids of the simulator outputs that it is made of.
        max_age: as ``InputBinding`` has it.
        timeout_s: seconds after which its kind or its expression takes it as unknown.
        every_message: no message is skipped.
        reads: names that its expression reads; ``None`` without one.
    """

    id: str
    attribute: str
    requires: tuple[str, ...] = ()
    max_age: float | str | None = None
    timeout_s: float | None = None
    every_message: bool = False
    reads: tuple[str, ...] | None = None


@dataclass(frozen=True)
class MonitorFacts:
    """Content of the answer ``facts_json``.

    Attributes:
        kind: name of the kind.
        id: of the model.
        digest: of all that decides what the monitor computes; robots compare it.
        file: name of the model file.
        file_sha256: of its bytes.
        inputs: in the order of the configuration.
        path: EMF fragment path of the model in an EDDI.
        claims: what it claims.
        acceptances: what it accepts in place of what is not known.
        elements: in the order of the model.
        links: path of an element -> what is linked with it in the EDDI.
    """

    kind: str
    id: str
    digest: str
    file: str
    file_sha256: str
    inputs: tuple[InputFacts, ...]
    path: str | None = None
    claims: tuple[Claim, ...] = ()
    acceptances: tuple[Acceptance, ...] = ()
    elements: tuple[Element, ...] = ()
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
