"""What a network costs is known before anything is allocated."""

import pytest

from eddi_scaffold.kinds.bayesian_network.clique_tree import (
    elimination_order,
    fewest_edges,
    smallest_table,
)
from eddi_scaffold.kinds.bayesian_network.inference_plan import LARGE, TOO_LARGE, width_of
from runtime_lib.tests.bayesian_network.networks import grid

pytestmark = pytest.mark.slow


def test_a_chain_is_narrow():
    chain = grid(1, 300)
    width = width_of(chain, [299], range(299))
    assert width.largest <= 64
    assert not width.too_large


def test_cost_depends_on_the_width_not_on_the_number_of_nodes():
    wide = width_of(grid(8, 8), [63], range(0, 60, 4))
    assert wide.largest <= 2**11
    assert wide.nanoseconds < 200_000
    assert wide == width_of(grid(8, 8), [63], range(0, 60, 4))


def test_a_wide_network_is_recognised_without_memory():
    width = width_of(grid(24, 24), [24 * 24 - 1], range(24 * 24 - 1))
    assert width.too_large
    assert width.largest > TOO_LARGE > LARGE
    assert len(width.nodes) > 20


def test_elimination_orders_are_complete_and_the_same_each_time():
    shape = grid(5, 5)
    masks = [sum(1 << one for one in (*own, k)) for k, own in enumerate(shape.parents)]
    for rule in (fewest_edges, smallest_table):
        order = elimination_order(masks, shape.cards, rule)
        assert sorted(order) == list(range(25))
        assert order == elimination_order(masks, shape.cards, rule)
