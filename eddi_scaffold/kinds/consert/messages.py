"""ROS messages of ConSert monitors.

``Guarantee`` and ``ConSertOutput`` are frozen: packages made by the tools of SESAME D7.2 and
their consumers use them, and any change of a field changes the MD5 and cuts all of them off.
Facts that D7.2 does not publish are in separate messages.
"""

from __future__ import annotations

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

MESSAGES = {
    "ConSertOutput": CONSERT_OUTPUT,
    "ConSertStatus": CONSERT_STATUS,
    "Guarantee": GUARANTEE,
    "GuaranteeStatus": GUARANTEE_STATUS,
}
"""ROS message name -> text of its ``.msg`` file."""
