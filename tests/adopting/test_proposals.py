"""Declarations that do what a body does: read from its tests, in whatever order they stand."""

from __future__ import annotations

from eddi_scaffold.packages.adopting.old_package import Body
from eddi_scaffold.packages.adopting.proposals import use_of
from tests.data_files import tabled

OUTCOMES = {"outcome_A": "A", "outcome_B": "B", "outcome_C": "on"}


def proposal(body: str) -> str | None:
    text = body.replace("x", "self.dra_data.x").replace("; ", "\n")
    found = use_of("Node", Body(text, ""), OUTCOMES, {"xok"}).proposal
    return found and found.removeprefix("Node: ")


def chain(*tests: str) -> str:
    """Return tests that set the outcomes one after another; an empty one is the last else."""
    words = ["if", "elif", "elif"]
    return "".join(
        f"{f'{word} {test}' if test else 'else'}:\n    outcome_{state} = 1.0\n"
        for word, test, state in zip(words, tests, "ABC", strict=False)
    )


@tabled
def test_a_chain_of_tests_is_a_declaration(tests: list[str], expected: str) -> None:
    assert proposal(chain(*tests)) == expected


def test_so_is_a_chain_behind_another_name() -> None:
    assert proposal(f"held = xok\n{chain('held', '')}") == "{input: xok, map: {true: A, false: B}}"


@tabled
def test_another_form_gets_no_proposal(tests: list[str]) -> None:
    assert proposal(chain(*tests)) is None


def test_nor_does_what_is_no_chain() -> None:
    for body in ("outcome_A = 1.0\n", f"print()\n{chain('x <= 5', '')}", ""):
        assert proposal(body) is None
