"""What a network costs is known before anything is allocated."""

import pytest

from eddi_scaffold.compiling.bayesian_network.elimination import (
    elimination_order,
    fewest_edges,
    smallest_table,
)
from eddi_scaffold.compiling.bayesian_network.programs import foreseen
from eddi_scaffold.compiling.bayesian_network.width import (
    LARGE,
    TOO_LARGE,
    TooWideError,
    width_of,
)
from eddi_scaffold.compiling.document import ModelError
from runtime_lib.tests.bayesian_network.networks import grid, monitor, network, node

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


def test_a_wide_network_is_refused_without_memory():
    shape = grid(24, 24)
    tables = [[0.5] * 2 ** (1 + len(one)) for one in shape.parents]
    net = network(shape.cards, shape.parents, tables)
    with pytest.raises(TooWideError, match=f"limit is {TOO_LARGE}; observe fewer nodes") as caught:
        foreseen(net, [24 * 24 - 1], range(24 * 24 - 1), trials=1)
    assert caught.value.width.largest > TOO_LARGE > LARGE
    assert len(caught.value.width.nodes) > 20


def test_a_model_file_that_is_too_wide_is_refused():
    """Every two of 14 roots have an observed child: one table over all of them."""
    roots = [node(f"p{k}", "a b c d", (), [0.25] * 4) for k in range(14)]
    children = [
        node(f"c{k}_{j}", "t f", [f"p{k}", f"p{j}"], [0.5] * 32)
        for k in range(14)
        for j in range(k)
    ]
    with pytest.raises(ModelError, match="too wide: one table over p0, p1, "):
        monitor(roots + children, outputs=["p0"], observed=[one["id"] for one in children])


def test_elimination_orders_are_complete_and_the_same_each_time():
    shape = grid(5, 5)
    masks = [sum(1 << one for one in (*own, k)) for k, own in enumerate(shape.parents)]
    for rule in (fewest_edges, smallest_table):
        order = elimination_order(masks, shape.cards, rule)
        assert sorted(order) == list(range(25))
        assert order == elimination_order(masks, shape.cards, rule)
