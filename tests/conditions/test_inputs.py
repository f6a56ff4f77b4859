"""Expressions of inputs: checked with places in the configuration, evaluated over messages."""

from types import SimpleNamespace
from typing import Any

from eddi_runtime.expressions.expression import Expression

from eddi_scaffold.common.problems import Place
from eddi_scaffold.conditions.analysis import ExpressionText, compile_input
from eddi_scaffold.conditions.scope import BOOL, NUMBER, Variable
from runtime_lib.tests.event.event_models import expression as expression_of
from tests.data_files import tabled

VARIABLES = {
    "battery.percentage": Variable("battery.percentage", NUMBER, timeout=10**9),
    "motor.temps[1]": Variable("motor.temps[1]", NUMBER),
    "link.up": Variable("link.up", BOOL),
    "load": Variable("load", NUMBER),
}


def text(expression: str, state: str | None = None) -> ExpressionText:
    """An expression that stands in line 7 of a configuration from column 18 on."""
    return ExpressionText(
        expression, lambda offset: Place("eddi_config.yml", 7, 18 + offset), state
    )


def compiled(kind: Any, *texts: ExpressionText, **more: Any) -> Any:
    return compile_input(texts, kind, rate=10, variables=VARIABLES, **more)


def made(kind: Any, *texts: ExpressionText, **more: Any) -> Expression:
    result, problems = compiled(kind, *texts, **more)
    assert problems == []
    return expression_of(result.document)


def battery(percentage: object) -> dict[str, object]:
    return {"battery": SimpleNamespace(percentage=percentage)}


def test_evidence_over_a_message() -> None:
    result, _ = compiled("bool", text("battery.percentage > 0.3 AND motor.temps[1] < 80"))
    assert result.requires == ("battery", "motor")
    entry = expression_of(result.document)
    assert tuple(entry.names) == ("battery", "motor")
    motor = {"motor": SimpleNamespace(temps=[20.0, 30.0])}
    assert entry.value(0, {**battery(0.5), **motor}) is True
    assert entry.value(1, {**battery(0.1), **motor}) is False
    assert entry.value(2, battery(0.5)) is None
    assert entry.value(3, {**battery(0.5), **motor}, {"battery": 1.5, "motor": 0.0}) is None


@tabled
def test_places_are_those_of_the_configuration(kind, expression, code, column):
    result, problems = compiled(kind, text(expression))
    assert result is None
    assert [(p.code, p.place.file, p.place.line, p.place.col) for p in problems] == [
        (code, "eddi_config.yml", 7, column)
    ]


def test_declarations_stand_beside_the_inputs() -> None:
    declared = "CONST limit = 60 ENUM Mode { AUTO, MANUAL } VAR mode : Mode TIMEOUT 1s"
    entry = made("bool", text("load > limit AND mode == AUTO"), declarations=declared)
    assert entry.value(0, {"load": 61, "mode": "AUTO"}) is True
