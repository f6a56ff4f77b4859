"""Message trees become messages that are filled completely, and every value is checked."""

import pytest
from eddi_runtime.node.topics import (
    MessageError,
    Output,
    channels,
    check_outputs,
    picked,
)

from runtime_lib.tests.node.message_package import EDDI_MESSAGES, STD_MSGS, converter, package


def status(**changed):
    one = ("GuaranteeStatus", {"id": "G", "verdict": 2, "missing": ["E"], **changed})
    fields = {"model_id": "M", "model_digest": "d", "guarantees": [one], "accepted": []}
    return "ConSertStatus", fields


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("verdict", -1),
        ("verdict", 256),
        ("verdict", True),
        ("verdict", 1.0),
        ("id", None),
        ("id", b"G"),
        ("missing", "E"),
        ("missing", [None]),
        ("missing", None),
    ],
)
def test_a_value_of_another_type_is_refused_by_its_field(field, value):
    with pytest.raises(MessageError, match=rf"GuaranteeStatus.{field}: .* expected, got "):
        converter().message(status(**{field: value}))


@pytest.mark.parametrize("value", [None, 1, "True", float("nan")])
def test_nothing_is_taken_for_a_truth_value(value):
    with pytest.raises(MessageError, match=r"Guarantee.active: bool expected"):
        converter().message(("Guarantee", {"id": "G", "active": value}))


def test_a_field_may_be_spelt_as_in_the_document():
    text = "bool omission\nbool oddViolation\nfloat32 significance_level\n"
    message = converter(package("eddi_messages", {"SafeMLOutput": text})).message(
        ("SafeMLOutput", {"omission": False, "odd_violation": True, "significance_level": 0.5})
    )
    assert message.oddViolation is True


def test_other_fields_than_the_message_has_are_refused():
    with pytest.raises(MessageError, match=r"surplus.*rebuild"):
        converter().message(status(surplus=1))
    with pytest.raises(MessageError, match=r"the message has active, id; rebuild"):
        converter().message(("Guarantee", {"id": "G"}))
    with pytest.raises(MessageError, match=r"Nothing is not in eddi_messages.msg"):
        converter().message(("Nothing", {}))


@pytest.mark.parametrize("inner", [status()[1]["guarantees"][0], ("Guarantee",), None, "G"])
def test_a_message_inside_is_of_the_declared_class(inner):
    with pytest.raises(MessageError, match=r"ConSertOutput.guarantees: eddi_messages/Guarantee"):
        converter().message(("ConSertOutput", {"guarantees": [inner]}))


def test_a_step_gives_one_message_or_several_or_none():
    trees = [("Guarantee", {"id": name, "active": False}) for name in "AB"]
    convert = converter()
    assert [message.id for message in convert.messages(trees)] == ["A", "B"]
    assert convert.messages(trees[0]).id == "A"
    assert convert.messages(None) is None


@pytest.mark.parametrize(
    ("name", "value", "expected"),
    [
        ("Float64", 3, 3.0),
        ("Float32", float("inf"), float("inf")),
        ("Float32", -3.4e38, -3.4e38),
        ("Int8", -128, -128),
        ("UInt64", 2**64 - 1, 2**64 - 1),
        ("Pair", (1, 2), [1, 2]),
    ],
)
def test_numbers_that_fit(name, value, expected):
    found = converter(STD_MSGS).message((name, {"data": value})).data
    assert (type(found), found) == (type(expected), expected)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("Float32", 1e39),
        ("Float64", "1"),
        ("Float64", True),
        ("Float64", 10**400),
        ("Int8", 128),
        ("UInt64", -1),
        ("Pair", [1, 2, 3]),
        ("Pair", [1, 200]),
    ],
)
def test_numbers_that_do_not_fit(name, value):
    with pytest.raises(MessageError, match=f"{name}.data"):
        converter(STD_MSGS).message((name, {"data": value}))


def test_values_of_numpy_become_plain_ones():
    np = pytest.importorskip("numpy", reason="the values are numpy's")
    convert = converter(STD_MSGS)
    for name, given, expected in (
        ("Int8", np.int64(5), 5),
        ("Bool", np.bool_(1), True),
        ("Float64", np.float32(0.5), 0.5),
        ("String", np.str_("text"), "text"),
    ):
        found = convert.message((name, {"data": given})).data
        assert (type(found), found) == (type(expected), expected)


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
