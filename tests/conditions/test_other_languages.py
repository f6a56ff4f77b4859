"""What people bring from elsewhere: units of several words, symbols of logic."""

import pytest

from tests.cli.command import ROOT, run

SLOW = ROOT / "tests" / "data" / "oracles" / "field" / "slash-units" / "slow.events"


def refused(*words: str) -> str:
    result = run("event", *words, "--rate", "10", "--check", cwd=ROOT)
    assert result.status == 2, result.out
    return result.err


def test_a_unit_with_a_slash_in_a_file() -> None:
    err = refused("--file", str(SLOW))
    assert "2:32: error: a unit is one word here, not m/s [E009]" in err
    assert "hint: write 2 mps" in err


@pytest.mark.parametrize(
    ("text", "hint"),
    [
        ("v > 10 km/h", "10 kmph"),
        ("w > 3 deg/s", "3 degps"),
        ("f > 3 1/h", "3 Hz or kHz or FIT"),
        ("t < 2 N*m", "2 Nm"),
        ("b > 2 A*h", "2 Ah"),
        ("a < 2 m/s^2", "x * x, or a unit in one word such as mps2"),
        ("VAR v : NUMBER RANGE 0 .. 2 m/s TIMEOUT 1s\nv > 1", "2 mps"),
        ("a -> b", "IMPLIES"),
        ("a => b", "IMPLIES, or >= to compare"),
        ("CONST limit = 2 m/s\nv > limit", "2 mps"),
    ],
)
def test_what_is_written_instead(text: str, hint: str) -> None:
    assert f"hint: write {hint}" in refused(text)


def test_a_declared_unit_of_several_words_is_one_mistake() -> None:
    err = refused("VAR v : NUMBER UNIT m/s TIMEOUT 500ms\nEVENT slow := v < 2 mps")
    assert "hint: write UNIT mps" in err
    assert "1 error\n" in err
    assert "W003" not in err


@pytest.mark.parametrize("text", ["v / 2 s > 1", "v > 5 km / t", "x <-5"])
def test_a_division_is_one(text: str) -> None:
    assert run("event", text, "--rate", "10", "--check", cwd=ROOT).status == 0
