"""Places in a YAML text, for changes that keep every other character."""

import pytest

from eddi_scaffold.common.problems import EddiError
from eddi_scaffold.yaml_text.spans import spans


@pytest.mark.parametrize("character", ["\0", "\x07", "\ufffe"])
def test_a_character_that_yaml_has_not_is_named(character: str) -> None:
    with pytest.raises(EddiError) as refused:
        spans(f"a: 1\nb: 2 # {character}\n", "eddi_config.yml")
    (problem,) = refused.value.problems
    assert (problem.code, problem.place.line, problem.place.col) == ("K001", 2, 8)
    assert "cannot stand in YAML" in problem.message
