"""The metrics as text; needs the extra ``metrics`` (prometheus-client)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily
from prometheus_client.openmetrics.exposition import CONTENT_TYPE_LATEST, generate_latest

from eddi_scaffold.watch.fleet import Snapshot
from eddi_scaffold.watch.metrics.families import families

CONTENT_TYPE: str = CONTENT_TYPE_LATEST


class _Collected:
    """What the library calls a registry."""

    def __init__(self, snapshot: Snapshot) -> None:
        self._snapshot = snapshot

    def collect(self) -> Iterator[Any]:
        for one in families(self._snapshot):
            made = CounterMetricFamily if one.type == "counter" else GaugeMetricFamily
            found: Any = made(one.name, one.help, labels=one.labels)
            for labels, value in one.samples.items():
                found.add_metric(labels, value)
            yield found


def exposed(snapshot: Snapshot) -> bytes:
    """Return the metrics of a fleet in the format OpenMetrics."""
    text: bytes = generate_latest(_Collected(snapshot))
    return text
