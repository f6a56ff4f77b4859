"""The network kind: random networks against brute force and pgmpy, formats, names, widths."""

import gzip
import importlib.util
import random
import subprocess
import sys
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.graphs import in_order
from eddi_scaffold.common.problems import Place
from eddi_scaffold.kinds import Model
from eddi_scaffold.kinds.bayesian_network import cross_check as crosscheck
from eddi_scaffold.kinds.bayesian_network import inference_plan
from eddi_scaffold.kinds.bayesian_network.network import Network, identifiers, xdsl_ids
from eddi_scaffold.kinds.bayesian_network.network_model import NetworkModel
from eddi_scaffold.kinds.bayesian_network.write import to_xdsl, to_xmlbif
from tests.cli.command import ROOT, run
from tests.diagnosed import assert_reported
from tests.interpreters import old_python
from tests.kinds.bayesian_network.networks import (
    joined,
    networks,
    of_states,
    read,
    read_path,
    running,
)

pytestmark = pytest.mark.slow

EXAMPLE = ROOT / "examples" / "pedestrian"


def model_of(network: Network) -> Model:
    return NetworkModel(network.name, Source("n.xdsl", b""), Place("n.xdsl"), data=network)


@given(networks())
def test_each_format_gives_back_the_same_network(network: Network) -> None:
    (model,) = read(to_xmlbif(network), "n.xmlbif").models
    assert model.data.nodes == network.nodes
    (model,) = read(to_xdsl(network), "n.xdsl").models
    parents = {node.id: node.parents for node in network.nodes}
    in_file = tuple(map(network.node, in_order(parents)))  # SMILE reads parents first
    assert model.data.nodes == in_file


@given(networks(4))
def test_the_cross_check_agrees(network: Network) -> None:
    pytest.importorskip("pgmpy", reason="the extra `bn` is not installed")
    model = model_of(network)
    monitor, _ = joined(model)
    assert monitor is not None
    result = monitor.model.cross_check(lambda: running(monitor))
    assert result.problems == ()
    assert result.text.startswith("Cross-checked with pgmpy: ")


@pytest.mark.parametrize("case", ["B306.differs", "B306.not_run"])
def test_a_cross_check_that_fails_or_is_not_run(case: str, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("pgmpy", reason="the extra `bn` is not installed")
    monkeypatch.setattr(crosscheck, "TOLERANCE", -1.0)
    for module in ("pgmpy", "pgmpy.inference") if case == "B306.not_run" else ():
        monkeypatch.setitem(sys.modules, module, None)
    monitor, _ = joined(read_path(EXAMPLE / "pedestrian.xml"))
    assert monitor is not None
    (problem,) = monitor.model.cross_check(lambda: running(monitor)).problems
    assert (problem.case, problem.place.file) == (case, str(EXAMPLE / "pedestrian.xml"))


@pytest.mark.parametrize("python", [lambda: sys.executable, old_python], ids=["this", "oldest"])
def test_figures_21_and_22_as_they_are_printed(tmp_path: Path, python: Callable[[], str]) -> None:
    words = ("generate", "--platform", "plain", "-o", tmp_path, "-m", "pedestrian.xml")
    assert run(*words, "-c", "eddi_config.yml", cwd=EXAMPLE).status == 0
    code = (
        "from pedestrian_prediction_example.bn_monitor import BayesianNetworkMonitor\n"
        "class InputData:\n"
        "    def __init__(self, speed, distance):\n"
        "        self.vehicleSpeed = speed\n"
        "        self.pedestrianDistance = distance\n"
        "bn_monitor = BayesianNetworkMonitor()\n"
        "print(bn_monitor.execute_step(InputData(4 / 3.6, 0.4)))\n"
        "print(bn_monitor.execute_step(InputData(4 / 3.6, 5.3)))\n"
    )
    done = subprocess.run(
        [python(), "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    start = (
        "[BayesianNetworkOutput(actor_id=0, bayesian_network_id='pedestrian_prediction_example', "
        "output_nodes=[Node(title='Critical', outcomes=[Outcome(name='Yes', value="
    )
    assert done.stdout.splitlines() == [
        f"{start}0.7), Outcome(name='No', value=0.3)])])]",
        f"{start}0.2), Outcome(name='No', value=0.8)])])]",
    ]


def grid(side: int, card: int) -> str:
    nodes = []
    for i in range(side):
        for j in range(side):
            above = [f"G{i - 1}_{j}"] if i else []
            left = [f"G{i}_{j - 1}"] if j else []
            rows = card ** len(above + left)
            given = f"<parents>{' '.join(above + left)}</parents>" if above + left else ""
            states = "".join(f'<state id="s{k}"/>' for k in range(card))
            values = " ".join([str(1 / card)] * card * rows)
            text = f"{states}{given}<probabilities>{values}</probabilities>"
            nodes.append(f'<cpt id="G{i}_{j}">{text}</cpt>')
    return f'<smile version="1.0" id="Grid"><nodes>{"".join(nodes)}</nodes></smile>'


def test_a_network_that_is_too_wide_is_shown_and_drawn_but_no_monitor(tmp_path: Path) -> None:
    (tmp_path / "grid.xdsl").write_text(grid(6, 8))
    shown = run("show", "grid.xdsl", cwd=tmp_path)
    assert shown.status == 0, shown.err
    assert "G5_5: s0, s1, s2, s3, s4, s5, s6, s7" in shown.out
    assert_reported("B301", shown.err)
    assert run("diagram", "grid.xdsl", "-o", "grid.svg", cwd=tmp_path).status == 0
    assert "G5_5" in (tmp_path / "grid.svg").read_text("utf-8")
    config = of_states(["G5_5"], ["G0_0"])
    monitor, problems = joined(read_path(tmp_path / "grid.xdsl"), config)
    assert monitor is None
    assert "B301.too_large" in [problem.case for problem in problems]


def test_names_in_python_and_in_xdsl() -> None:
    assert identifiers(["a b", "a_b", "<7.5", ">=7.5", "2x", "class", "ä", "\u3000"]) == [
        "a_b", "a_b_2", "_7_5", "__7_5", "2x", "class", "ä", "_",
    ]  # fmt: skip
    assert xdsl_ids(["CO2 report", "CO2_report", "2nd", "ä"]) == {
        "CO2_report": "CO2_report",
        "CO2 report": "CO2_report_2",
        "2nd": "n_2nd",
        "ä": "_",
    }


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


COMPARED = ("water", *(name for name in SIZES if name not in ("earthquake", "survey")))
SETS = 100 if settings.default.max_examples > 1000 else 3
"""Of evidence, hard only, and hard and virtual; more in the long profile."""


@pytest.mark.parametrize("tables", [True, False])
@pytest.mark.parametrize("name", COMPARED)
def test_public_networks_have_the_posteriors_of_pgmpy(
    name: str, tables: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of two nodes, for evidence of half of the others, hard and soft."""
    limits = {"TOLERANCE": 1e-12, "EVERY_CASE": 0, "CASES": SETS, "SOFT_CASES": SETS}
    for key, value in limits.items():
        monkeypatch.setattr(crosscheck, key, value)
    if not tables:
        monkeypatch.setattr(inference_plan, "fits", lambda *_: False)
    (model,) = read(shipped(name), "n.bif").models
    names = model.data.names()
    picked = random.Random(name).sample(names, len(names))
    observed = picked[2 : 2 + min(len(names) // 2, 12)]
    monitor, problems = joined(model, of_states(picked[:2], observed))
    assert monitor is not None, problems
    result = monitor.model.cross_check(lambda: running(monitor))
    assert result.problems == ()


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
