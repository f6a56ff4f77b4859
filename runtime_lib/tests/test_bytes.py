"""A ``byte`` of a message is ``bytes`` of length 1 in rclpy, and a number everywhere else."""

from types import SimpleNamespace as Give

import numpy as np
import pytest
from eddi_runtime.expressions import number
from eddi_runtime.expressions.expression import Expression, read_path
from eddi_runtime.expressions.lists import column
from eddi_runtime.plain_values import by_key, joined, plain
from eddi_runtime.safeml.arrays import take

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
