"""Reliability models of texts, compiled as the generator compiles them."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

from eddi_runtime.reliability import Reliability

from eddi_scaffold.common.files import Source, read_source
from eddi_scaffold.common.problems import Problem, in_order
from eddi_scaffold.eddi_xml.document import read_document
from eddi_scaffold.kinds import Model, Options
from eddi_scaffold.kinds.reliability.compile import compile_system
from eddi_scaffold.kinds.reliability.reliability_model import ReliabilityModel
from eddi_scaffold.program.input_expressions import BoundInput
from eddi_scaffold.program.monitor_text import Declaration
from runtime_lib.tests.bound_models import loaded


def compiled(model: Model) -> Reliability:
    inputs = tuple(BoundInput(input_.id, input_.id) for input_ in model.inputs())
    declaration = Declaration("m", "", inputs)
    parts = compile_system(model.data, declaration)
    made: Reliability = loaded("reliability", parts, declaration).Monitor()
    return made


def read_text(
    text: str, name: str = "reliability_config.yml"
) -> tuple[Model | None, list[Problem]]:
    reading = ReliabilityModel.read_file(Source(name, text.encode()), ())
    return (reading.models[0] if reading.models else None), list(reading.problems)


def sound(text: str) -> Model:
    model, problems = read_text(text)
    assert model is not None, problems
    configured, problems = model.configure(Options())
    assert configured is not None, problems
    return configured


def everything(text: str, name: str = "reliability_config.yml") -> list[Problem]:
    model, problems = read_text(text, name)
    if model is not None:
        problems += model.check()
        problems += model.configure(Options())[1]
    return in_order(problems)


def models_of(path: Path) -> tuple[dict[str, Model], list[Problem]]:
    source = read_source(path)
    document, problems = read_document(source)
    assert document is not None
    reading = ReliabilityModel.read_eddi(document, source, ())
    return {one.name: one for one in reading.models}, [*problems, *reading.problems]


def at_start(model: Model, **values: Any) -> Any:
    return compiled(model).execute_step(SimpleNamespace(**values), 0)
