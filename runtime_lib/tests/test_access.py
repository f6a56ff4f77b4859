"""What a hand-written line or a configuration takes out of a list by id."""

from types import SimpleNamespace

import pytest
from eddi_runtime import EDDIInputBase, by_id


def element(name, active):
    return SimpleNamespace(id=name, active=active)


def test_the_element_of_an_id():
    items = [element("A", False), SimpleNamespace(), element("B", True)]
    assert by_id(iter(items), "B").active


@pytest.mark.parametrize(
    ("ids", "message"),
    [
        ("", "no element has the id 'B'; there: nothing"),
        ("AC", "no element has the id 'B'; there: A, C"),
        ("BAB", "2 elements have the id 'B'; there: B, A, B"),
    ],
)
def test_none_or_several(ids, message):
    with pytest.raises(LookupError) as caught:
        by_id([element(name, True) for name in ids], "B")
    assert str(caught.value) == message


class Input(EDDIInputBase):
    """An input that takes what a generated package takes."""

    def __init__(self):
        super().__init__()
        self.E = None

    def process(self, scope):
        self.E = by_id(scope.evidence, "E").active

    def processing(self, simulator_outputs):
        self.update("E", self.process, simulator_outputs, ("scope",))


def test_an_id_twice_counts_as_unknown():
    eddi_input = Input()
    eddi_input.processing({"scope": SimpleNamespace(evidence=[element("E", True)])})
    assert eddi_input.E is True
    twice = [element("E", True), element("E", False)]
    eddi_input.processing({"scope": SimpleNamespace(evidence=twice)})
    assert eddi_input.E is None
    state = eddi_input.states["E"]
    assert state.state == "invalid"
    assert "2 elements have the id 'E'" in state.reason
