"""A ConSert and its configuration: a list of inputs that changes in the ways of real models."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Input:
    """One input: its name, the message that it reads, and the name that it had."""

    id: str
    topic: str = ""
    type: str = "bool"
    renamed_from: str | None = None

    @property
    def source(self) -> str:
        return self.topic or f"S_{self.id}"


def inputs_of(items: Sequence[object]) -> tuple[Input, ...]:
    """Return inputs as the cases write them: a name, or a map."""
    return tuple(Input(**item) if isinstance(item, dict) else Input(str(item)) for item in items)


def write_inputs(folder: Path, inputs: Sequence[Input]) -> tuple[Path, Path]:
    """Write model and configuration; returns their paths."""
    model, config = "evidence:\n", "Model:\n  id: Rover\n  type: ConSert\nSimulatorOutputs:\n"
    for item in inputs:
        model += f"  {item.id}: {'1 .. 2 m' if item.type == 'float' else 'bool'}\n"
        message = "std_msgs.Float64" if item.type == "float" else "std_msgs.Bool"
        config += f"  - {{id: {item.source}, type: {message}, topic: /{item.source.lower()}}}\n"
    model += f"guarantees: {{Drive: {' AND '.join(item.id for item in inputs)}}}\n"
    config += "EDDIInputs:\n"
    for item in inputs:
        default = "" if item.type == "float" else ", default: false"
        former = f", renamed_from: {item.renamed_from}" if item.renamed_from else ""
        config += (
            f"  - {{id: {item.id}, type: {item.type}, requires: [{item.source}], max_age: none"
            f"{default}{former}}}\n"
        )
    config += "EDDIOutputs:\n  - {id: rover, topic: /rover/guarantees}\n"
    folder.mkdir(parents=True, exist_ok=True)
    paths = folder / "Rover.yml", folder / "eddi_config.yml"
    for path, text in zip(paths, (model, config), strict=True):
        path.write_text(text)
    return paths
