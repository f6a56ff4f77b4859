"""Types of variables that nobody declares: from how they are used, wherever that is."""

import pytest

from eddi_scaffold.conditions import analyse
from eddi_scaffold.conditions.scope import BOOL, NUMBER


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("x > 5", {"x": NUMBER}),
        ("NOT a", {"a": BOOL}),
        ("x == 5", {"x": NUMBER}),
        ("TRUE != a", {"a": BOOL}),
        ("x + 1 == y", {"x": NUMBER, "y": NUMBER}),
        ("(x > 1) == a", {"x": NUMBER, "a": BOOL}),
        ("x == y AND y > 3", {"x": NUMBER, "y": NUMBER}),
        ("y > 3 AND x == y", {"x": NUMBER, "y": NUMBER}),
        ("x == y AND y == z AND NOT x", {"x": BOOL, "y": BOOL, "z": BOOL}),
        ("x == y AND z == w AND y == w AND z < 1", dict.fromkeys("xyzw", NUMBER)),
        ("x == x AND x > 1", {"x": NUMBER}),
        ("KNOWN(x) AND AGE(x) < 1 AND x > 2", {"x": NUMBER}),
    ],
)
def test_one_side_has_the_type_of_the_other(text: str, expected: dict[str, object]) -> None:
    result = analyse(text, rate=10)
    assert [entry.message for entry in result.problems] == []
    assert {entry.name: entry.type for entry in result.variables} == expected


@pytest.mark.parametrize("text", ["x == y", "KNOWN(x)", "x == y AND y == z AND z == x"])
def test_what_no_use_decides_is_asked_for(text: str) -> None:
    result = analyse(text, rate=10)
    assert result.program is None
    assert {entry.code for entry in result.problems} == {"E008"}
