#!/usr/bin/env python3
"""Write ``docs/reference/messages.md`` from the messages of the kinds.

script/messages.py    # after a change of a kind's messages.py
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "runtime_lib" / "src")]

from eddi_scaffold.kinds import kinds  # noqa: E402 - of this checkout

PAGE = ROOT / "docs" / "reference" / "messages.md"
_HEAD = """# Messages

<!-- written by script/messages.py from the messages.py of each kind -->

What monitors publish, as `eddi_messages/NAME`; a workspace has only those that its monitors need.
Probabilities lie between 0 and 1; times are in seconds where the name says no other unit
(`mttf_hours`). Messages are published in each step, the last one is latched. Of a ConSert, a
network and a SafeML monitor, `NAMEOutput` is on the topic of `EDDIOutputs` and `NAMEStatus` on
`<topic>/status`; thresholds of a network are on `<topic>/evidence`. [What monitors may read of each
other](reading-monitors.md) says which field counts as evidence; why a claim does not hold is on
[`<topic>/why`](nodes.md#topic-why).
"""

_MEANINGS = {
    "Guarantee": "`id`: as in the model. `active`: it holds now; false also while that is unknown.",
    "ConSertOutput": "All guarantees of one ConSert, with the definition of SESAME D7.2.",
    "BayesianNetworkOutput": "The posteriors of the output nodes, as SESAME D7.2 defines them.",
    "NodeOutput": "`title`: id of the node. `outcomes`: its states.",
    "OutcomeOutput": "`outcome_name`: the state. `outcome_value`: its probability.",
    "SafeMLOutput": "`omission`: there is no verdict. `odd_violation`: the verdict, or the last"
    " one. `significance_level`: that of the configuration.",
}
"""What messages mean whose text is frozen: a comment in it would be another text."""


def document() -> str:
    """Return the page."""
    return "\n".join([_HEAD, *_sections()])


def _sections() -> Iterator[str]:
    for _, kind in sorted(kinds().items()):
        yield f"## {kind.title}\n"
        for message, text in kind.all_messages.items():
            yield f"### `{message}`\n"
            if message in _MEANINGS:
                yield f"{_MEANINGS[message]}\n"
            yield f"```text\n{text.strip()}\n```\n"


if __name__ == "__main__":
    PAGE.write_text(document(), "utf-8")
