"""The kind ``bayesian_network``: exact posteriors, from what sensors say (D7.2 3.2)."""

from __future__ import annotations

import importlib
import re
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from eddi_scaffold.kinds import Alias, Kind
from eddi_scaffold.kinds.bayesian_network.claims import MEANINGS, accepted, lag, support
from eddi_scaffold.kinds.bayesian_network.messages import MESSAGES

if TYPE_CHECKING:
    from eddi_scaffold.source import Source

_SUFFIXES = (".xdsl", ".xmlbif", ".bif", ".xml")
_METHODS = "bayesian_network_config.py"
_HEAD = 65536
_ROOT = re.compile(rb"<(?:smile|BIF)[\s>/]")
_KEYS = (
    "outputs", "observed", "discretisation", "evidence_mode", "on_inconsistent", "explain",
    "renamed", "evidence",
)  # fmt: skip


def _later(module: str, name: str) -> Callable[..., Any]:
    """Return a function of the kind; what it needs is imported when it is called."""

    def call(*values: Any) -> Any:
        return getattr(importlib.import_module(f"{__name__}.{module}"), name)(*values)

    return call


def _sniff(source: Source) -> bool:
    name = source.name.lower()
    if name.endswith((*_SUFFIXES[:2], _METHODS)):
        return True
    if not name.endswith(_SUFFIXES):
        return False
    with source.open() as stream:
        return _ROOT.search(stream.read(_HEAD)) is not None


KIND = Kind(
    name="bayesian_network",
    title="Bayesian network",
    config_types=("BayesianNetwork", "Bayesian Network", "bayesian_network"),
    read_eddi=_later("functions", "read_eddi"),
    sniff=_sniff,
    read_file=_later("functions", "read_file"),
    check=_later("functions", "check"),
    counts=_later("functions", "counts"),
    outline=_later("functions", "outline"),
    export=_later("functions", "export"),
    inputs=_later("functions", "inputs"),
    runtime_model=_later("functions", "runtime_model"),
    messages=MESSAGES,
    output_message="BayesianNetworkOutput",
    beside=_later("functions", "beside"),
    options=_KEYS,
    configure=_later("options", "configure"),
    inputs_of_model=False,
    settings=_later("functions", "settings"),
    modules=_later("functions", "modules"),
    aliases=(
        Alias(
            "bn_monitor",
            "bayesian_network",
            ("BayesianNetworkOutput", "Monitor", "Node", "Outcome"),
            ("BayesianNetworkMonitor",),
        ),
    ),
    requirements=("numpy",),
    cross_check=_later("crosscheck", "cross_check"),
    readme=_later("functions", "readme"),
    diagram=_later("picture", "diagram"),
    outputs=_later("functions", "outputs"),
    ids=_later("functions", "ids"),
    accepted=accepted,
    lag=lag,
    support=support,
    meanings=lambda _document, _part: MEANINGS,
)
"""What the generator knows of Bayesian networks."""
