"""Which message, or which value of it, goes to which topic, checked before a node starts."""

import pytest
from eddi_runtime.node.topics import (
    MessageError,
    Output,
    channels,
    check_outputs,
    picked,
)

from runtime_lib.tests.node.message_package import EDDI_MESSAGES, STD_MSGS, converter

TREE = ("ConSertOutput", {"guarantees": [("Guarantee", {"id": "G", "active": True})]})
FITTING, WRONG = EDDI_MESSAGES.ConSertOutput, EDDI_MESSAGES.Guarantee


class Beside:
    """A monitor that says more than its result."""

    def status_message(self):
        return "ConSertOutput", {"guarantees": [("Guarantee", {"id": "H", "active": False})]}


def check(output, tree=TREE):
    check_outputs(converter(), tree, Beside(), [output])


@pytest.mark.parametrize(
    "path", [("guarantees", ("id", "G"), "active"), ("guarantees", 0, "active")]
)
def test_one_value_of_a_message_is_published_alone(path):
    output = Output("g", "/g", STD_MSGS.Bool, field=path)
    (channel,) = channels([output])
    assert picked(converter().message(TREE), channel).data is True
    check(output)


def test_a_value_that_is_not_there_is_refused_with_its_topic():
    other = Output("g", "/g", STD_MSGS.Bool, field=("guarantees", ("id", "H"), "active"))
    with pytest.raises(MessageError, match=r"/g: .*H"):
        check(other)
    check(other._replace(of="status"))
    with pytest.raises(MessageError, match=r"/g: .*no"):
        check(other._replace(field=("no",)))


def test_messages_beside_the_result_have_topics_of_their_own():
    row = Output("g", "/g", FITTING, of="status")
    old = Output("g", "/g", FITTING, "/g/status", FITTING)
    for output in (row, old):
        check(output, tree=None)
    with pytest.raises(
        MessageError,
        match=r"/g/status carries eddi_messages/Guarantee, the monitor makes eddi_messages/ConSert",
    ):
        check(old._replace(status_type=WRONG))
    with pytest.raises(MessageError, match=r"no message 'evidence'"):
        check(row._replace(of="evidence"))
    assert converter().beside(Beside(), "status").guarantees[0].id == "H"
