"""Other tools read what `export` writes, and see the same distribution."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings

from eddi_scaffold.kinds.bayesian_network.model import Network
from eddi_scaffold.kinds.bayesian_network.to_xdsl import to_xdsl
from eddi_scaffold.kinds.bayesian_network.to_xmlbif import to_xmlbif
from tests.kinds.bayesian_network.networks import networks

pytestmark = pytest.mark.slow

TEXTS = {"xdsl": to_xdsl, "xmlbif": to_xmlbif}


def read_by_pgmpy(network: Network, form: str, folder: Path) -> Any:
    readwrite = pytest.importorskip("pgmpy.readwrite", reason="the extra `bn` is not installed")
    path = folder / f"net.{form}"
    path.write_text(TEXTS[form](network), "utf-8")
    reader = {"xdsl": readwrite.XDSLReader, "xmlbif": readwrite.XMLBIFReader}[form]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.simplefilter("ignore", DeprecationWarning)  # of pgmpy by itself
        warnings.simplefilter("ignore", FutureWarning)
        return reader(str(path)).get_model()


@pytest.mark.parametrize("form", list(TEXTS))
@settings(max_examples=15)
@given(network=networks())
def test_pgmpy_reads_the_same_tables(
    tmp_path_factory: pytest.TempPathFactory, form: str, network: Network
) -> None:
    model = read_by_pgmpy(network, form, tmp_path_factory.mktemp("peer"))
    assert set(model.nodes()) == set(network.names())
    for node in network.nodes:
        table = model.get_cpds(node.id)
        assert table.variables == [node.id, *node.parents]
        assert tuple(table.state_names[node.id]) == node.states
        width = len(node.states)
        for k in range(width):  # a row of pgmpy holds one state under every combination
            assert table.get_values()[k].tolist() == list(node.table[k::width])
