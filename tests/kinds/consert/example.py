"""One small ConSert with everything in it, as text."""

from __future__ import annotations

from typing import TYPE_CHECKING

from eddi_scaffold.common.files import Source
from eddi_scaffold.kinds.consert.consert_model import ConSertModel

if TYPE_CHECKING:
    from eddi_scaffold.kinds import Model

ROVER = """\
---
guarantees:
  - id: FastDrive
    description: Drives at full speed
    dimensions:
      - Binary:
          type: Driving
    ranking: 1
  - id: SlowDrive
    dimensions:
      - Binary:
          type: Driving
      - Numeric:
          type: Speed
          covered:
            - Inclusive:
                start: 0
                end: 1.50
          subset: Demand
          uom: m/s
  - id: StandStill
    dimensions:
      - Binary:
          type: Standing
    default: true
demands:
  - id: MapKnown
    dimensions:
      - Categorical:
          type: MapAge
          covered:
            - new
            - "1e3"
            - "no"
          subset: Guarantee
evidence:
  - id: Distance
    dimension:
      Numeric:
        type: Clearance
        covered:
          - Exclusive:
              start: 0.5
              end: .inf
          - Inclusive:
              start: -1
              end: 0
        subset: Demand
        uom: ""
  - id: Lidar
    description: "The lidar's \\"self test\\": passed"
    dimension:
      Binary:
        type: Healthy
gates:
  - id: Both
    function: And
tree_propagations:
  - from: Distance
    to: Both
  - from: MapKnown
    to: Both
  - from: Both
    to: FastDrive
  - from: Lidar
    to: FastDrive
  - from: Lidar
    to: SlowDrive
required_services:
  - id: Mapping
    functional_service_type: MapService
    demands:
      - MapKnown
provided_services:
  - id: Drive
    functional_service_type: Motion
    guarantees:
      - FastDrive
      - SlowDrive
      - StandStill
"""


def read(text: str, name: str = "Rover.yml", marks: tuple[str, ...] = ()) -> Model:
    reading = ConSertModel.read_file(Source(name, text.encode()), marks)
    assert [p for p in reading.problems if p.level == "error"] == []
    (model,) = reading.models
    return model
