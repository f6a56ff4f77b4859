"""The kind ``bayesian_network``: exact posteriors, from sensor values (D7.2 3.2)."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from eddi_scaffold.eddi_xml.vocabulary import NETWORKS
from eddi_scaffold.kinds import Alias, Kind
from eddi_scaffold.kinds.bayesian_network.messages import MESSAGES, VERDICTS

if TYPE_CHECKING:
    from eddi_scaffold.common.files import Source

_SUFFIXES = (".xdsl", ".xmlbif", ".bifxml", ".bif", ".xml")
_METHODS = "bayesian_network_config.py"
_HEAD = 65536
_ROOT = re.compile(rb"<(?:smile|BIF)[\s>/]")
_KEYS = (
    "outputs", "observed", "discretisation", "evidence_mode", "on_inconsistent", "explain",
    "renamed", "evidence",
)  # fmt: skip


def _recognises(source: Source) -> bool:
    name = source.name.lower()
    if name.endswith((*_SUFFIXES[:4], _METHODS)):
        return True
    if not name.endswith(_SUFFIXES):
        return False
    with source.open() as stream:
        return _ROOT.search(stream.read(_HEAD)) is not None


KIND = Kind(
    name="bayesian_network",
    title="Bayesian network",
    config_types=("BayesianNetwork", "Bayesian Network", "bayesian_network"),
    recognises=_recognises,
    messages=MESSAGES,
    output_message="BayesianNetworkOutput",
    verdicts=VERDICTS,
    model="network_model.NetworkModel",
    topic="posteriors",
    in_eddi=NETWORKS,
    options=_KEYS,
    inputs_of_model=False,
    aliases=(
        Alias(
            "bn_monitor",
            "bayesian_network",
            ("BayesianNetworkOutput", "Monitor", "Node", "Outcome"),
            ("BayesianNetworkMonitor",),
        ),
    ),
    requirements=("numpy",),
)
"""What the generator knows of Bayesian networks."""
