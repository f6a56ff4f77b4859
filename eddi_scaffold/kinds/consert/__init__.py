"""The kind ``consert``: conditional safety certificates, evaluated while the system runs.

``Guarantee`` and ``ConSertOutput`` are frozen: packages made by the tools of SESAME D7.2 and
their consumers use them, and any change of a field changes the MD5 and cuts all of them off.
Facts that D7.2 does not publish are in separate messages.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from eddi_scaffold.common.claims import StatusReading, Verdict, state_of
from eddi_scaffold.kinds import Kind

if TYPE_CHECKING:
    from eddi_scaffold.common.files import Source

OPTION_KEYS = ("guarantee_ids", "debounce", "filter")
"""Keys of ``Model:`` in a configuration."""

GUARANTEE = "string id\nbool active\n"

CONSERT_OUTPUT = "Guarantee[] guarantees\n"

GUARANTEE_STATUS = """\
# Why a guarantee is active or not.
uint8 FALSE=0
uint8 UNKNOWN=1
uint8 TRUE=2
# Id as in the model.
string id
# Active means TRUE and nothing else.
uint8 verdict
# Smallest set of inputs that would have to become good, empty while active.
string[] missing
"""

CONSERT_STATUS = """\
# The facts behind a ConSertOutput.
std_msgs/Header header
# Which model was evaluated: its id and the SHA-256 of its data.
string model_id
string model_digest
GuaranteeStatus[] guarantees
# What the configuration accepts in this step, and guarantees may rest on: `RtE_E0: max_age: none`.
string[] accepted
"""

ROBOT_GUARANTEES = """\
# The word of one robot to all others: what it guarantees, and until when that counts.
string robot
# Which model gives the guarantees: its id and the SHA-256 of its data.
string model_id
string model_digest
# Another one after each start of the node, and the number of the word in it, from 1 on.
string session
uint64 sequence
# Seconds after which this word counts as unknown, on the clock of whoever relies on it.
float64 lease
# The node relies on words of others: they echo the last one that they heard of it.
bool listens
RobotGuarantee[] guarantees
Heard[] heard
"""

ROBOT_GUARANTEE = """\
string id
bool active
# On whose words it rests, as ROBOT/MODEL, with those behind them: none of them relies on it.
string[] rests_on
"""

HEARD = """\
# An echo: the last word that was heard of a node.
string robot
string model_id
string session
uint64 sequence
"""

BETWEEN_ROBOTS = {
    "Heard": HEARD,
    "RobotGuarantee": ROBOT_GUARANTEE,
    "RobotGuarantees": ROBOT_GUARANTEES,
}
"""Messages that a workspace has where its robot is one of a fleet, as ``MESSAGES``."""

MESSAGES = {
    "ConSertOutput": CONSERT_OUTPUT,
    "ConSertStatus": CONSERT_STATUS,
    "Guarantee": GUARANTEE,
    "GuaranteeStatus": GUARANTEE_STATUS,
}
"""ROS message name -> text of its ``.msg`` file."""
_UNKNOWN, _TRUE = 1, 2


def _status(status: Any) -> StatusReading:
    verdicts = tuple(
        Verdict(
            guarantee.id,
            state_of(active=guarantee.verdict == _TRUE, known=guarantee.verdict != _UNKNOWN),
            tuple(guarantee.missing),
        )
        for guarantee in status.guarantees
    )
    return StatusReading(verdicts, status.model_id, status.model_digest, tuple(status.accepted))


_SUFFIXES = (".yml", ".yaml", ".json")
_OWN_KEY = re.compile(
    rb"""(?m)^(?:\{\s*)?["']?(?:guarantees|tree_propagations|(?:provided|required)_services)"""
    rb"""["']?\s*:"""
)


def _recognises(source: Source) -> bool:
    return source.name.lower().endswith(_SUFFIXES) and _OWN_KEY.search(source.data) is not None


KIND = Kind(
    name="consert",
    title="ConSert",
    config_types=("ConSert", "ConSerts"),
    recognises=_recognises,
    messages=MESSAGES,
    between_robots=BETWEEN_ROBOTS,
    output_message="ConSertOutput",
    verdicts={"ConSertStatus": _status},
    model="consert_model.ConSertModel",
    topic="guarantees",
    in_eddi=".",  # its reader says what is misspelt, too
    options=OPTION_KEYS,
    without_input="no guarantee that needs it becomes active",
)
"""What the generator knows of ConSerts."""
