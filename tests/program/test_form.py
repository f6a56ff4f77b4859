"""The program of conditions: no name becomes code."""

from eddi_scaffold.program.instructions import reads_of_results
from eddi_scaffold.program.running import Engine
from runtime_lib.tests.event.event_models import form


def test_no_word_of_a_form_becomes_code():
    evil = '"); import os; os.abort() #'
    named = {"x": {"name": evil}, "m": {"literals": (evil,)}}
    found = form(("gt", "x", 5), ("eq_enum", "m", ("literal", 0)), variables=("x", "m"), **named)
    results = tuple(result._replace(id=evil) for result in found.results)
    engine = Engine(found._replace(results=results))
    assert engine.step(0, [6.0, evil]) == (2, 2)
    assert engine.step(1, [4.0, "else"]) == (0, 1)


def test_which_reads_decide_a_result():
    program = form(("gt", "x", 5), ("or", "a", ("gt", ("age", "y"), 1)))
    assert reads_of_results(program) == [[0], [1, 2]]
