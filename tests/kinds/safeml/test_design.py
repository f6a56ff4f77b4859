"""What is tested: the numbers that the robot gets, in the same form as its samples."""

import numpy as np

from eddi_scaffold.kinds.safeml.scope import Design


def test_a_sample_equal_to_a_row_has_equal_values() -> None:
    """Else rounding noise makes quantised samples differ from their own reference."""
    chance = np.random.RandomState(6)
    rows = np.round(chance.normal(size=(80, 12)), 1)
    design = Design(rows, components=5, residual=True, halves=True)
    for k, row in enumerate(rows[:40]):
        values = design.values(row)
        for test, value in enumerate(values):
            assert value in design.reference[test], (k, test)


def test_axes_have_few_digits() -> None:
    """Their last ones differ between machines."""
    rows = np.random.RandomState(2).normal(size=(90, 5))
    table = Design(rows, components=3, residual=True, halves=True).table
    assert table is not None
    vectors = table[2:]
    assert (np.round(vectors, 12) == vectors).all()
    np.testing.assert_allclose(vectors @ vectors.T, np.eye(3), atol=1e-11)


def test_a_sample_in_the_plane_of_the_axes_has_no_residual() -> None:
    """The digits that axes lack are no residual."""
    chance = np.random.RandomState(4)
    rows = chance.normal(size=(100, 2)) @ chance.normal(size=(2, 40)) * 1e6 + 1e5
    design = Design(rows, components=2, residual=True, halves=True)
    assert {design.values(row)[2] for row in rows} == {0.0}
