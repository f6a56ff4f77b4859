"""Other tools and this one see the same distribution in each other's files."""

import gzip
import importlib.util
import warnings
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings

from eddi_scaffold.kinds.bayesian_network.network import Network
from eddi_scaffold.kinds.bayesian_network.write import to_xdsl, to_xmlbif
from tests.kinds.bayesian_network.networks import networks, read, read_path

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


def shipped(name: str) -> bytes:
    """Return the BIF text of a public network that pgmpy brings along."""
    found = importlib.util.find_spec("pgmpy")
    if found is None or found.origin is None:
        pytest.skip("the extra `bn` is not installed")
    folder = Path(found.origin).parent / "utils" / "example_models"
    return gzip.decompress((folder / f"{name}.bif.gz").read_bytes())


@pytest.fixture(scope="module")
def public() -> tuple[bytes, Any]:
    """Return a public network as BIF text, and as pgmpy reads it."""
    text = shipped("asia")
    from pgmpy.readwrite import BIFReader

    return text, BIFReader(string=text.decode()).get_model()


SIZES = {
    "alarm": (37, 752), "asia": (8, 36), "cancer": (5, 20),
    "child": (20, 344), "earthquake": (5, 20), "hailfinder": (56, 3741),
    "insurance": (27, 1419), "sachs": (11, 267), "survey": (6, 37), "win95pts": (76, 1148),
}  # fmt: skip
"""Public network -> its nodes, and the numbers in its tables."""


@pytest.mark.parametrize("name", SIZES)
def test_public_networks_are_read(name: str) -> None:
    reading = read(shipped(name), "n.bif")
    assert {one.code for one in reading.problems} <= {"B113"}
    nodes = reading.models[0].data.nodes
    assert (len(nodes), sum(len(node.table) for node in nodes)) == SIZES[name]


@pytest.mark.parametrize("form", ["bif", "xdsl"])
def test_what_pgmpy_writes_is_read(public: tuple[bytes, Any], form: str, tmp_path: Path) -> None:
    from pgmpy import readwrite

    text, peer = public
    writer = {"bif": "BIFWriter", "xdsl": "XDSLWriter"}[form]
    path = tmp_path / f"n.{form}"
    getattr(readwrite, writer)(peer).write(str(path))
    found = {node.id: node for node in read_path(path).data.nodes}
    for node in read(text, "n.bif").models[0].data.nodes:
        mine = found[node.id]
        assert (mine.states, mine.parents) == (node.states, node.parents)
        assert mine.table == pytest.approx(node.table, abs=1e-12)
