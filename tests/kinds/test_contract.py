"""What every kind promises: the same tests for each, on its worked example."""

import json
import math
import shutil
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import yaml
from eddi_runtime.inputs import InputState
from eddi_runtime.why import TRUE, claim_why

from eddi_scaffold.common.files import Source, read_source
from eddi_scaffold.common.problems import has_errors
from eddi_scaffold.deployments.joining import packages_of
from eddi_scaffold.diagrams.svg import drawn
from eddi_scaffold.kinds import Kind, Model, kinds
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.loading import read_models
from eddi_scaffold.monitors.message_types import known_messages
from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.platforms import platforms
from eddi_scaffold.recordings.node import Publications
from eddi_scaffold.recordings.playing import compiled
from tests.checkouts import HERE
from tests.kinds.examples import EXAMPLES

each_kind = pytest.mark.parametrize("kind", kinds().values(), ids=list(kinds()))


def files_of(kind: Kind) -> tuple[Path, Path]:
    model, config = EXAMPLES[kind.name]
    return HERE / "examples" / model, HERE / "examples" / config


def model_of(kind: Kind) -> Model:
    models = read_models(read_source(files_of(kind)[0])).models
    return next(model for model in models if model.kind == kind.name)


def monitor_of(kind: Kind) -> BoundMonitor:
    model, config = files_of(kind)
    (monitor,), problems = monitors_of(model, [config])
    assert not has_errors(problems)
    return monitor


def test_every_kind_has_an_example() -> None:
    assert sorted(EXAMPLES) == list(kinds())


def test_descriptions_are_cheap() -> None:
    """To list the kinds, nobody waits for numpy, lxml or the runtime."""
    program = (
        "import sys; from eddi_scaffold.kinds import kinds; kinds(); "
        "print(sorted({'numpy', 'lxml', 'yaml', 'eddi_runtime'} & set(sys.modules)))"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert done.stdout == "[]\n"


@each_kind
def test_it_recognises_its_own_files(kind: Kind) -> None:
    for name, text in model_of(kind).export().items():
        if Path(name).suffix == ".csv":
            continue
        exported = Source(name, text.encode())
        assert [one.name for one in kinds().values() if one.recognises(exported)] == [kind.name]


@each_kind
def test_what_it_exports_it_reads_back(kind: Kind, tmp_path: Path) -> None:
    (model, *_) = (
        m for m in read_models(read_source(files_of(kind)[0])).models if m.kind == kind.name
    )
    exported = model.export()
    for name, text in exported.items():
        (tmp_path / name).write_text(text, "utf-8")
    for name in exported:
        if Path(name).suffix == ".csv":
            continue
        (again,) = read_models(read_source(tmp_path / name)).models
        assert again.kind == kind.name
        assert again.counts() == model.counts()
        assert again.export()[name] == (tmp_path / name).read_text("utf-8")


@each_kind
@pytest.mark.parametrize("platform", platforms().values(), ids=list(platforms()))
def test_every_platform_has_a_package_for_it(kind: Kind, platform: Any) -> None:
    monitor = monitor_of(kind)
    (package,), problems = packages_of([monitor], platform, None)
    assert not has_errors(problems)
    assert package.folder == monitor.package
    json.dumps(package.answers)  # answers are plain data


@each_kind
def test_nothing_is_claimed_while_everything_is_unknown(kind: Kind) -> None:
    running = compiled(monitor_of(kind))
    unknown = SimpleNamespace(**{spec.attribute: None for spec in running.inputs})
    for second in range(3):
        output = running.execute_step(unknown, second * 10**9)
        claimed = {name for name, value in running.series(output).items() if value is True}
        assert claimed <= {"omission"}  # SafeML: there is no verdict
        json.dumps(running.as_json(output))
        assert all(one.sentence for one in running.why().values())


class Hostile:
    def __getattr__(self, name: str) -> Any:
        raise RuntimeError(name)

    __eq__ = __len__ = __float__ = __str__ = __repr__ = __getattr__  # type: ignore[assignment]
    __hash__ = None  # type: ignore[assignment]


VALUES = (None, True, False, 0.5, -1e9, 10**400, math.nan, math.inf, "x\0", [], [1.0], b"a")


@each_kind
def test_whatever_its_inputs_hold_it_says_why(kind: Kind) -> None:
    running = compiled(monitor_of(kind))
    claims: set[str] = set()
    for second, value in enumerate((*VALUES, Hostile(), object)):
        for time in (second * 10**9, "no time", -second):
            given = {spec.attribute: value for spec in running.inputs}
            running.execute_step(SimpleNamespace(**given), time)
            rows = [claim_why("m", *row) for row in running._whys()]
            claims |= {row.id for row in rows}
            for row in rows:
                assert (row.verdict == TRUE) == (not row.causes) == (not row.sentence)
                assert len(row.sentence) <= 402
                json.dumps(row.as_json())
    named = {one.id for one in monitor_of(kind).facts.claims} - {"", "odd_violation", "valid"}
    assert claims >= named


def without_limits(kind: Kind, folder: Path) -> BoundMonitor:
    """Return the monitor of the example, whose configuration lets no input grow old."""
    model, config = files_of(kind)
    shutil.copytree(config.parent, folder, dirs_exist_ok=True)
    document = yaml.safe_load(config.read_text("utf-8"))
    for entry in (*document["SimulatorOutputs"], *document["EDDIInputs"]):
        entry["max_age"] = "none"
    (folder / config.name).write_text(yaml.safe_dump(document), "utf-8")
    (monitor,), problems = monitors_of(folder / model.name, [folder / config.name])
    assert not has_errors(problems)
    return monitor


@each_kind
def test_what_is_accepted_stands_in_what_it_publishes(kind: Kind, tmp_path: Path) -> None:
    monitor = without_limits(kind, tmp_path)
    running, publisher = compiled(monitor), Publications(monitor)
    states = {spec.id: InputState("ok") for spec in running.inputs}
    limitless = {f"{spec.id}: max_age: none" for spec in running.inputs}
    for value, accepted in ((True, limitless), (None, set())):
        given = dict.fromkeys([spec.attribute for spec in running.inputs], value)
        output = running.execute_step(SimpleNamespace(states=states, **given), 0)
        assert set(running.accepted()) == accepted
        messages = [one for _, one in publisher.messages(running, output, publisher.topics)]
        # of SafeML, `accepted` is a number of samples
        name = "acceptances" if kind.name == "safeml" else "accepted"
        assert {text for one in messages for text in getattr(one, name, ())} == accepted


PYTHON_TYPES = {"bool": bool, "string": str, "float32": (int, float), "float64": (int, float)}


def assert_fits(tree: Any) -> None:
    """A node would refuse any other message."""
    name, fields = tree
    types = known_messages()[f"eddi_messages/{name}"]
    assert fields.keys() == {field for field, of in types.items() if of != "std_msgs/Header"}, name
    for field, value in fields.items():
        single = types[field].partition("[")[0]
        for item in value if types[field].endswith("]") else (value,):
            if isinstance(item, tuple):
                assert f"eddi_messages/{item[0]}" == single
                assert_fits(item)
            else:
                assert isinstance(item, PYTHON_TYPES.get(single, int)), (name, field, item)


@each_kind
@pytest.mark.parametrize("value", [True, None])
def test_its_messages_fit_their_definitions(kind: Kind, value: object, tmp_path: Path) -> None:
    monitor = without_limits(kind, tmp_path)
    running = compiled(monitor)
    states = {spec.id: InputState("ok") for spec in running.inputs}
    given = dict.fromkeys([spec.attribute for spec in running.inputs], value)
    output = running.execute_step(SimpleNamespace(states=states, **given), 0)
    trees = running.message(output)
    for tree in trees if isinstance(trees, list) else [trees]:
        assert_fits(tree)
    for name in monitor.model.companion_messages():
        assert_fits(getattr(running, f"{name}_message")())


@each_kind
def test_it_says_what_its_messages_mean(kind: Kind) -> None:
    monitor = monitor_of(kind)
    assert kind.output_message in kind.messages
    for message in kind.model_class.meanings(monitor.facts.claims):
        assert message in kind.all_messages
    inputs = {binding.model.id for binding in monitor.inputs}
    for claim in monitor.facts.claims:
        assert claim.rests_on <= inputs
    for message in monitor.model.companion_messages().values():
        assert message in kind.messages


@each_kind
def test_its_picture_is_drawn(kind: Kind) -> None:
    picture = monitor_of(kind).model.diagram()
    if picture is None:
        pytest.skip("the kind has no picture")
    assert drawn(picture).startswith("<svg")
