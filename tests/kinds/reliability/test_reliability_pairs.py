"""A reliability model and its configurations together."""

from __future__ import annotations

from pathlib import Path

import pytest

from eddi_scaffold.deployments.checking import check_files
from tests.kinds.reliability.test_reliability_example import EXAMPLE


def said(folder: Path, old: str, new: str) -> list[str]:
    text = (EXAMPLE / "reliability_config.yml").read_text("utf-8")
    assert text.count(old) >= 1
    config = folder / "config.yml"
    config.write_text(text.replace(old, new, 1), "utf-8")
    problems = check_files([EXAMPLE / "drone.xml", config])
    return [f"{p.place.line}:{p.place.col} {p.code} {p.message} | {p.hint}" for p in problems]


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        (
            "{Link:",
            "{Lnk:",
            "11:16 R001 there is no event of 'MissionLoss' 'Lnk' | did you mean 'Link'?",
        ),
        (
            "{observed: true}",
            "{observed: maybe}",
            "11:33 R002 observed: true or false is expected | None",
        ),
        (
            "Rotors:",
            "Rotrs:",
            "8:5 R001 model 'Rotrs' has no type | did you mean 'Rotors'?",
        ),
    ],
)
def test_only_the_cause_is_said(tmp_path: Path, old: str, new: str, expected: str) -> None:
    assert said(tmp_path, old, new) == [expected]


def test_an_input_that_nobody_provides_in_words_of_this_kind(tmp_path: Path) -> None:
    text = (EXAMPLE / "reliability_config.yml").read_text("utf-8")
    entry = text[text.index("  - id: MissionLoss_Link") : text.index("EDDIOutputs")]
    (one,) = said(tmp_path, entry, "")
    assert "K014 no entry of EDDIInputs provides 'MissionLoss_Link': it stays unknown, and " in one
    assert "p_fail is the worst case of it, and not valid" in one


def test_a_consert_takes_thresholds_that_are_there(tmp_path: Path) -> None:
    names = ("drone.xml", "reliability_config.yml")
    text = (EXAMPLE / "mission_config.yml").read_text("utf-8")
    config = tmp_path / "mission.yml"
    config.write_text(text.replace("[RtE_continue]", "[RtE_continu]"), "utf-8")
    problems = check_files([*(EXAMPLE / name for name in names), config])
    assert [(one.code, one.message, one.hint) for one in problems] == [
        (
            "K020",
            "'evidence[RtE_continu].active': MissionLoss publishes no 'RtE_continu'",
            "did you mean 'RtE_continue'?",
        )
    ]
