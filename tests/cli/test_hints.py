"""What a person may have meant is said where it is cheap to know."""

from pathlib import Path

import pytest

from tests.cli.command import run
from tests.data_files import data_text

MODEL = data_text("cli/hints.yml")
CONFIG = data_text("cli/hints_config.yml")


@pytest.fixture
def cart(tmp_path: Path) -> Path:
    (tmp_path / "cart.yml").write_text(MODEL)
    (tmp_path / "cart_config.yml").write_text(CONFIG)
    return tmp_path


def test_a_sign_is_not_percent(cart: Path) -> None:
    assert run("check", "cart_config.yml", cwd=cart).status == 0
    (cart / "sign.yml").write_text(CONFIG.replace("unit: fraction", "unit: %"))
    refused = run("check", "sign.yml", cwd=cart)
    assert (refused.status, "in quotes" in refused.err) == (1, True), refused.err
    (cart / "sign_model.yml").write_text(MODEL.replace("percent", '"%"'))
    refused = run("check", "sign_model.yml", cwd=cart)
    assert (refused.status, "hint: write percent" in refused.err) == (1, True), refused.err
    (cart / "drive.csv").write_text("t,Charge\n0.0,80%\n")
    refused = run("run", "cart_config.yml", "--inputs", "drive.csv", cwd=cart)
    assert (refused.status, "a number with a decimal point and no unit" in refused.err) == (2, True)


def test_a_fraction_that_is_never_accepted_is_told(cart: Path) -> None:
    without = MODEL.replace("percent", '""')
    (cart / "cart.yml").write_text(without)
    told = run("check", "cart_config.yml", cwd=cart)
    assert (told.status, "[K022]" in told.err, "`uom: percent`" in told.err) == (0, True, True)
    for ends, is_told in (
        ("start: 0.999, end: 100", False),
        ("start: 0.50001, end: 0.50002", False),
        ("start: -3, end: 0", False),
        ("start: -3, end: -0.1", True),
        ("start: 1, end: 1", False),
        ("start: 1.0000001, end: 2", True),
    ):
        assert "start: 20, end: 100" in without
        (cart / "cart.yml").write_text(without.replace("start: 20, end: 100", ends))
        told = run("check", "cart_config.yml", cwd=cart)
        assert ("[K022]" in told.err) is is_told, ends
