"""Which pictures a file gives."""

from __future__ import annotations

import pytest

from eddi_scaffold.common.problems import EddiError
from eddi_scaffold.monitors.exports import pictures
from tests.checkouts import HERE
from tests.diagnosed import assert_reported

MODEL = HERE / "examples" / "two-conserts" / "two_conserts.xml"


def test_one_picture_for_each_model() -> None:
    found, problems = pictures(MODEL, None, (), single=False)
    assert (list(found), problems) == (["ConSertA.svg", "ConSertB.svg"], [])
    assert list(pictures(MODEL, "ConSertB", (), single=True)[0]) == ["ConSertB.svg"]


def test_a_kind_without_pictures_says_so() -> None:
    events = HERE / "examples" / "motor-watch" / "motor_watch.events"
    with pytest.raises(EddiError) as refused:
        pictures(events, None, (), single=False)
    (problem,) = refused.value.problems
    assert_reported("G018", [problem])
