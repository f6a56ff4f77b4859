"""State machines of the data folder, configured and compiled as the generator does it."""

from pathlib import Path
from typing import Any

from eddi_scaffold.common.files import read_source
from eddi_scaffold.common.problems import Problem
from eddi_scaffold.kinds import DeclaredInput, Options
from eddi_scaffold.kinds.state_machine.state_machine_model import StateMachineModel
from eddi_scaffold.monitors.loading import read_models
from eddi_scaffold.program.input_expressions import BoundInput
from eddi_scaffold.program.monitor_text import Declaration
from runtime_lib.tests.bound_models import BoundModel
from tests.checkouts import HERE

DATA = HERE / "tests" / "data" / "oracles" / "state_machines"


def machine_of(path: Path) -> StateMachineModel:
    models = read_models(read_source(path)).models
    (model,) = (model for model in models if isinstance(model, StateMachineModel))
    return model


def options_of(values: dict[str, Any], inputs: dict[str, Any], frequency: float) -> Options:
    """Return options with the entries of `Model:`, and declared inputs with their types."""
    declared = tuple(
        DeclaredInput(name, of, None, None, Options().place()) for name, of in inputs.items()
    )
    return Options(values=values, inputs=declared, frequency=frequency)


def configured(
    model: StateMachineModel, options: Options
) -> tuple[StateMachineModel, list[Problem]]:
    made, problems = model.configure(options)
    assert made is not None, problems
    return made, problems


def running(model: StateMachineModel) -> Any:
    inputs = (BoundInput(one.id, one.id, every_message=one.every_message) for one in model.inputs())
    return BoundModel(model, Declaration(model.name, "0" * 64, tuple(inputs))).monitor()
