"""Any value as a plain one or as a short text, whatever its class does; a problem in one line."""

from types import SimpleNamespace as Give

import numpy as np
import pytest
from eddi_runtime.expressions import number
from eddi_runtime.expressions.expression import Expression, read_path
from eddi_runtime.expressions.lists import column
from eddi_runtime.plain_values import by_key, joined, one_line, plain, show, type_name
from eddi_runtime.safeml.arrays import take


class Hostile(type):
    """The class of a class that does not tell its name."""

    @property
    def __name__(cls):
        raise RuntimeError


class Liar(int, metaclass=Hostile):
    __class__ = bool

    def __int__(self):
        raise RuntimeError

    def __repr__(self):
        raise RuntimeError


class MuteError(Exception):
    def __str__(self):
        raise RuntimeError


def test_a_subclass_is_asked_nothing():
    assert (type(plain(Liar(3))), show(Liar(3)), type_name(Liar(3))) == (int, "3", "Liar")


def test_what_is_no_plain_value_is_shown_by_its_type():
    assert [plain(one) for one in (None, [1], 1j, b"xy")] == [None] * 4
    assert show([1]) == "an object of type list"
    assert show(10**100) == "a whole number of 333 bits"
    assert len(show("x" * 500)) == 60


def test_a_problem_is_one_line_that_every_transport_can_send():
    assert one_line(ValueError("first\n second")) == "ValueError: first second"
    assert one_line(ValueError()) == "ValueError"
    assert one_line(MuteError()) == "MuteError: it cannot be printed"
    assert len(one_line(ValueError("x" * 5000))) == 312
    found = one_line(OSError("no file /data/\udcff"))
    assert found.encode("utf-8") == b"OSError: no file /data/\\udcff"


LEVELS = (b"\x00", b"\x02", b"2", b"\xff")


@pytest.mark.parametrize("level", LEVELS)
def test_one_byte_is_its_number(level):
    value = level[0]
    message = Give(level=level, status=[Give(level=level)])
    assert plain(level) == number(level) == value
    assert read_path(message, ["level"]) == read_path(message, ["status", 0, "level"]) == value
    assert by_key(message.status, "level", value) is message.status[0]
    assert column(read_path(message, ["status", ["*"], "level"]), "level") == [value]


def test_a_byte_can_mark_what_is_no_measurement():
    messages = {"m": Give(level=b"\x03", x=1.5)}
    check = ("unless", ["level"], 3)
    assert Expression().field(messages, "m", ["x"], check) is None
    messages["m"].level = b"\x00"
    assert Expression().field(messages, "m", ["x"], check) == 1.5


def test_lists_of_bytes():
    data = [b"\x00", b"\x02", b"2"]
    layout = Give(data_offset=1, dim=[])
    assert column(data, "data") == [0.0, 2.0, 50.0]
    for given, expected in (
        (data, [0, 2, 50]),
        (Give(layout=layout, data=data), [2, 50]),
        (joined(data, Give(layout=layout, data=data), 0.5), [0, 2, 50, 2, 50, 0.5]),
    ):
        taken = take(given, len(expected), single=False)
        assert [row.tolist() for row in taken.rows] == [expected]
    assert take([b"ab", b"c"], 2, single=False).rows == []
    assert take(np.array([0, 2], np.uint8), 2, single=False).rows[0].tolist() == [0, 2]
