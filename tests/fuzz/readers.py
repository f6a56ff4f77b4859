"""Everything that reads files of people, as the commands do it, without starting a command."""

import codecs
import contextlib
import itertools
import json
import shutil
from collections.abc import Callable, Iterator, Sequence
from copy import copy
from dataclasses import replace
from functools import partial
from pathlib import Path

from eddi_scaffold.common.files import Source, read_source
from eddi_scaffold.common.identifiers import TODO
from eddi_scaffold.common.problems import EddiError, has_errors
from eddi_scaffold.conditions.analysis import analyse
from eddi_scaffold.conditions.standalone import as_json, as_text, generate
from eddi_scaffold.config.topic_block import read_block, rewritten
from eddi_scaffold.connect.draft import entry
from eddi_scaffold.connect.keeping import Draft, topics_of, with_draft
from eddi_scaffold.connect.matching import decide
from eddi_scaffold.connect.topics import InputNeed, RobotTopic
from eddi_scaffold.deployments.checking import check_files
from eddi_scaffold.deployments.fleet_checks import picture_of_fleet, sites_of
from eddi_scaffold.diagrams.svg import drawn
from eddi_scaffold.eddi_xml.document import recognises as is_xml
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.compiling import from_json
from eddi_scaffold.monitors.config_reading import read_config
from eddi_scaffold.monitors.exports import written_into
from eddi_scaffold.monitors.loading import checked_models, read_models
from eddi_scaffold.monitors.message_types import known_messages
from eddi_scaffold.monitors.survey import survey_of
from eddi_scaffold.mros import MrosSyntaxError, read_ros_models, read_rossystem
from eddi_scaffold.mros.show import model_json, model_tree, system_json, system_tree
from eddi_scaffold.packages.assembly import assemble, monitors_of
from eddi_scaffold.packages.rendering import ANSWERS_FILE
from eddi_scaffold.packages.tracing import trace_of
from eddi_scaffold.packages.upgrading import groups, targets
from eddi_scaffold.platforms import platforms
from eddi_scaffold.recordings.bags import read_bag
from eddi_scaffold.recordings.members import Member, read_values
from eddi_scaffold.recordings.playing import ROWS, compiled, play, played
from eddi_scaffold.recordings.results import changes, steps
from eddi_scaffold.regions.check import list_regions
from eddi_scaffold.regions.markers import Marker, read_marker
from eddi_scaffold.regions.package import Plan
from eddi_scaffold.regions.sync import plan_sync
from tests.adopting.old_networks import write_old_network
from tests.adopting.old_packages import write_old_ros_package
from tests.cli.command import ROOT, files_below
from tests.data_files import FOREIGN, ORACLES, data_text
from tests.diagnosed import Cases
from tests.fuzz.damage import Reader, Sample
from tests.mros.test_reading import INDENT_MODEL, MODEL, SYSTEM
from tests.package_texts import INPUT, eddi_input

EXAMPLES = ROOT / "examples"
MAPS = Path(__file__).parents[1] / "eddi_xml" / "models"
SMALL = 20_000
"""Bytes of the largest sample: damage to a large file takes long and finds no more."""

MANY = 10
"""Monitors of one file that become packages; a fault tree of many tops has one for each."""


def readers(folder: Path, names: Sequence[str]) -> dict[str, Reader]:
    """Return some readers; each works in a folder of its own."""
    made = {}
    for name in names:
        place = folder / name.replace(" ", "-")
        place.mkdir(parents=True)
        samples, attempt = _MAKERS[name](place)
        made[name] = Reader(name, samples, attempt)
    return made


Steps = Iterator[None]
Made = tuple[Sequence[Sample], Callable[[Sample], Steps]]


def _samples(paths: Sequence[Path | str], oracles: str = "") -> list[Sample]:
    """Return sound files: examples, and oracles."""
    found = [EXAMPLES / path for path in paths]
    found += sorted(ORACLES.glob(oracles)) if oracles else []
    return [Sample(p.name, p.read_bytes()) for p in found if p.stat().st_size <= SMALL]


def without_cross_check(monitor: BoundMonitor) -> BoundMonitor:
    """Return a monitor that is not compared with an independent tool, which takes its time."""
    model = copy(monitor.model)
    object.__setattr__(model, "cross_check", lambda _: None)
    return replace(monitor, model=model)


def used(path: Path) -> Steps:
    """Do with a model what check, show, diagram, export and generate do before they write."""
    source = read_source(path)
    check_files([path], hazards=is_xml(source))
    yield
    if is_xml(source):  # of other files the survey is the models and their counts, as below
        survey_of(source)
        yield
    reading = read_models(source)
    for model in () if has_errors(reading.problems) else reading.models:
        json.dumps([list(model.outline()), dict(model.counts()), dict(model.export())])
        yield
        picture = model.diagram()
        if picture is not None:
            drawn(picture)
    yield
    yield from _generated(path)


def _configured(model: Path, config: Path) -> Steps:
    """Do with a sound model what check and generate do; show and the like see no configuration."""
    check_files([model, config])
    yield
    yield from _generated(model, [config], "ros1")


def _generated(path: Path, configs: Sequence[Path] = (), platform: str = "plain") -> Steps:
    with contextlib.suppress(EddiError):
        yield from _compiled(path, configs, platform)


def _compiled(path: Path, configs: Sequence[Path], platform: str) -> Steps:
    monitors, problems = monitors_of(path, configs)
    yield
    # a cross-check is the work of another library, which is not here everywhere
    monitors = [without_cross_check(one) for one in monitors]
    for one in monitors[:MANY]:
        made = assemble([one], platforms()[platform], path.parent / "packages", problems)
        yield
        for package in made.packages:
            if "facts" in package.answers:
                trace_of(package.answers)
        compiled(one)
        yield


def _models(
    *files: str, oracles: str = "", more: Callable[[], Sequence[Sample]] = list
) -> Callable[[Path], Made]:
    def make(folder: Path) -> Made:
        beside = {Path(file).parent for file in files}
        for path in (one for name in beside for one in (EXAMPLES / name).iterdir()):
            if path.is_file():
                shutil.copy(path, folder / path.name)

        def attempt(sample: Sample) -> Steps:
            path = folder / f"damaged-{sample.name}"
            path.write_bytes(sample.data)
            yield from used(path)

        return [*_samples(files, oracles), *more()], attempt

    return make


def _deployment(folder: Path) -> Made:
    for path in (EXAMPLES / "two-robots").iterdir():
        shutil.copy(path, folder / path.name)

    def attempt(sample: Sample) -> Steps:
        path = folder / f"damaged-{sample.name}"
        path.write_bytes(sample.data)
        check_files([path])
        yield
        with contextlib.suppress(EddiError):
            picture_of_fleet(read_source(path), checked_models)
            sites_of(read_source(path), checked_models)
        yield

    more = _text("whole.yml", "fuzz/deployment.yml")()
    return [*_samples(["two-robots/deployment.yml"]), *more], attempt


def _written(folder: Path) -> Made:
    """Write events into an EDDI: it stays as it is, or has the events and all that it had."""
    (events,) = read_models(read_source(EXAMPLES / "motor-watch/motor_watch.events")).models
    samples = _samples([f"{MAPS}/{name}.xml" for name in ("landing", "rover_hazards")])

    def attempt(sample: Sample) -> Steps:
        source = Source(str(folder / sample.name), sample.data)
        before = read_models(source)
        yield
        for at in ("/", "//@odeProductPackages.0/@systems.0"):
            with contextlib.suppress(EddiError):
                after = read_models(Source(source.name, written_into(source, at, [events])))
                names = {one.name for one in before.models} | {events.name}
                assert {one.name for one in after.models} == names
            yield

    return samples, attempt


def _exported(suffix: str) -> list[Sample]:
    found = []
    for path in (EXAMPLES / "pedestrian/pedestrian.xml", *sorted(ORACLES.glob("bn/net_[abc].xml"))):
        for model in read_models(read_source(path)).models:
            for name, text in model.export().items():
                if name.endswith(suffix) and len(text) <= SMALL:
                    found.append(Sample(name, text.encode()))
    return found


def _text(name: str, text: str) -> Callable[[], Sequence[Sample]]:
    return lambda: [Sample(name, data_text(text).encode())]


def _config(folder: Path) -> Made:
    """Configurations beside the models that they belong to."""
    samples, model_of = [], {}
    for name, model in (
        ("two-conserts/consert_a_config.yml", "two_conserts.xml"),
        ("two-conserts/consert_b_config.yml", "two_conserts.xml"),
        ("pedestrian/eddi_config.yml", "pedestrian.xml"),
        ("drone/reliability_config.yml", "drone.xml"),
        ("drone/mission_config.yml", "drone.xml"),
        ("rover-events/eddi_config.yml", "Rover.yml"),
        ("motor-watch/motor_config.yml", "motor_watch.events"),
        ("safeml/perception_config.yml", "safeml_config.yml"),
        ("shuttle/shuttle_config.yml", "shuttle.xml"),
    ):
        path = EXAMPLES / name
        place = folder / path.parent.name
        if not place.exists():
            shutil.copytree(path.parent, place, ignore=shutil.ignore_patterns("expected"))
        sample = Sample(f"{path.parent.name}/damaged_{path.name}", path.read_bytes())
        samples.append(sample)
        model_of[sample.name] = place / model

    _shorten(folder / "safeml/reference_sample.csv", 200)

    def attempt(sample: Sample) -> Steps:
        path = folder / sample.name
        path.write_bytes(sample.data)
        source = Source(str(path), sample.data)
        read_config(source)
        with contextlib.suppress(EddiError):
            block = read_block(source)
            rewritten(block, [])
            drafted = _drafted(topics_of(block), sample.name)
            with_draft(block, drafted)
        yield
        yield from _configured(model_of[sample.name], path)

    return samples, attempt


def _drafted(topics: Sequence[RobotTopic], name: str) -> Draft:
    """Return what `connect` would write for two inputs, one of which may be there."""
    needs = [InputNeed("RtE_A_E0", "bool"), InputNeed(name, "float")]
    entries = [entry(one, {}) for one in decide(needs, topics, known_messages().get)]
    options = {"discretisation": {"A": {"bins": TODO}}}
    return Draft({}, options, {}, entries)


def _shorten(path: Path, lines: int) -> None:
    path.write_bytes(b"\n".join(path.read_bytes().split(b"\n")[:lines]))


def _of_eddi_editor() -> list[Sample]:
    folder = ORACLES / "state_machines"
    return [Sample(name, (folder / name).read_bytes()) for name in ("pumps.id.xml", "duo.json")]


def _reliability() -> list[Sample]:
    cases = Cases(ROOT / "tests/kinds/reliability/diagnostics.txt").inputs.values()
    return [Sample("case.yml", text.encode()) for text in cases]


def _safeml(folder: Path) -> Made:
    config, rows = (EXAMPLES / "safeml" / n for n in ("safeml_config.yml", "reference_sample.csv"))
    few = b"\n".join(rows.read_bytes().split(b"\n")[:60])
    samples = [Sample("safeml_config.yml", config.read_bytes()), Sample(rows.name, few)]

    def attempt(sample: Sample) -> Steps:
        (folder / "safeml_config.yml").write_bytes(config.read_bytes())
        (folder / rows.name).write_bytes(few)
        (folder / sample.name).write_bytes(sample.data)
        yield from used(folder / "safeml_config.yml")

    return samples, attempt


def _events(folder: Path) -> Made:
    samples = _samples(["motor-watch/motor_watch.events"])
    samples += _text("many.events", "fuzz/many.events")()

    def attempt(sample: Sample) -> Steps:
        path = folder / sample.name
        path.write_bytes(sample.data)
        yield from used(path)
        with contextlib.suppress(UnicodeDecodeError):
            found = analyse(sample.data.decode("utf-8-sig"), rate=10)
            if found.program is not None:
                as_json(found)
                as_text(found)
                yield
                for target in ("python", "c"):
                    generate(found, target, "m")
                    yield

    return samples, attempt


def _robots(folder: Path) -> Made:
    paths = [p for p in sorted((EXAMPLES / "robot-models").rglob("*.ros*")) if p.is_file()]
    samples = _samples(paths)
    few = sorted(FOREIGN.glob("mros/corpus/**/*.ros*"))[::5]
    samples += [Sample(p.name, p.read_bytes()) for p in few if p.stat().st_size <= SMALL]
    texts = {"x.rossystem": SYSTEM, "x.ros": MODEL, "x.ros1": INDENT_MODEL}
    samples += [Sample(name, text.encode()) for name, text in texts.items()]

    def attempt(sample: Sample) -> Steps:
        with contextlib.suppress(MrosSyntaxError):
            if sample.name.endswith(".rossystem"):
                system = read_rossystem(sample.data, sample.name)
                json.dumps([system_json(system), list(system_tree(system))])
            else:
                model = read_ros_models(sample.data, sample.name)
                json.dumps([model_json(model), list(model_tree(model))])
        yield

    return samples, attempt


def _recordings(folder: Path) -> Made:
    samples = _samples(["two-conserts/recording.csv", "drone/recording.csv"])
    path = EXAMPLES / "two-conserts"
    (monitor,), _ = monitors_of(path / "two_conserts.xml", [path / "consert_a_config.yml"])

    def attempt(sample: Sample) -> Steps:
        with contextlib.suppress(EddiError):
            source = Source("damaged.csv", sample.data)
            members, recording, _ = read_values(source, [Member(monitor)])
            for rule in (None, ROWS):
                list(changes(itertools.islice(play(played(members, rule), recording), 100)))
        yield

    return samples, attempt


def _bags(folder: Path) -> Made:
    from tests.recordings.test_bags import demand, healthy, written

    path = folder / "a.bag"
    written(path, [healthy(0, False), healthy(0.25, True), demand(0.45, True), demand(1.2, False)])
    place = EXAMPLES / "two-conserts"
    (monitor,), _ = monitors_of(place / "two_conserts.xml", [place / "consert_a_config.yml"])

    def attempt(sample: Sample) -> Steps:
        path.write_bytes(sample.data)
        with contextlib.suppress(EddiError):
            members = [Member(monitor)]
            recording, _ = read_bag(path, members)
            for _ in itertools.islice(steps(play(played(members, ROWS), recording)), 100):
                pass
        yield

    return [Sample("a.bag", path.read_bytes())], attempt


def _answers(folder: Path) -> Made:
    """Packages of both platforms, whose answers a merge has damaged."""
    expected = EXAMPLES / "two-conserts/expected/src/eddi_monitor"
    samples = []
    for source in (ROOT / "tests/golden/plain/rover", *sorted(expected.iterdir())):
        if (source / ANSWERS_FILE).is_file():
            (folder / source.name).mkdir()
            data = (source / ANSWERS_FILE).read_bytes()
            samples.append(Sample(f"{source.name}/{ANSWERS_FILE}", data))

    def attempt(sample: Sample) -> Steps:
        path = folder / sample.name
        path.write_bytes(sample.data)
        with contextlib.suppress(EddiError):
            for group in groups(None, [path.parent]):
                targets(group, None, [])
                for answers in group.present.values():
                    if "facts" in answers:
                        trace_of(answers)
        yield

    return samples, attempt


def _facts(folder: Path) -> Made:
    """The facts of packages."""
    samples = []
    for name in (
        "two-conserts/two_conserts.xml",
        "pedestrian/pedestrian.xml",
        "drone/airframe.yml",
    ):
        found = monitors_of(EXAMPLES / name, [])[0]
        samples += [Sample(f"{one.package}.json", one.facts.to_json().encode()) for one in found]

    def attempt(sample: Sample) -> Steps:
        with contextlib.suppress(ValueError):
            from_json(sample.data.decode())
        yield

    return samples, attempt


def _sync(folder: Path) -> Made:
    """A package whose module, manifest and saved body are damaged in turn."""
    sound, package = folder / "sound", folder / "package"
    renderings = [folder / name for name in ("first", "second", "third")]
    for rendering, names in zip(renderings, (["E0", "E1"], ["E1"], ["E1", "E2"]), strict=True):
        (rendering / INPUT).parent.mkdir(parents=True)
        (rendering / INPUT).write_text(eddi_input(names))
    sound.mkdir()
    for rendering in renderings[:2]:
        _synced(plan_sync(sound, rendering))
        text = (sound / INPUT).read_text("utf-8")
        (sound / INPUT).write_text(text.replace("= message.data\n", "= not message.data\n"))
    samples = [Sample(name, data) for name, data in files_below(sound).items()]
    assert [one.name for one in samples] == [
        ".eddi/kept/process_E0.region",
        ".eddi/manifest",
        INPUT,
    ]

    def attempt(sample: Sample) -> Steps:
        shutil.rmtree(package, ignore_errors=True)
        shutil.copytree(sound, package)
        (package / sample.name).write_bytes(sample.data)
        before = files_below(package)
        yield
        list(list_regions(package))
        yield
        plan = plan_sync(package, renderings[2])
        yield
        assert files_below(package) == before, "a look changed a file"
        if plan.refusals:
            return
        _synced(plan)
        yield
        if sample.name == INPUT:
            made = [(rendering / INPUT).read_bytes() for rendering in renderings]
            _nothing_lost(sample, made, files_below(package))
        again = plan_sync(package, renderings[2])
        assert not again.refusals, "a second run refuses"
        assert not again.steps, "a second run changes a file"

    return samples, attempt


def _synced(plan: Plan) -> None:
    assert not plan.refusals
    plan.prepare()
    plan.finish()


def _nothing_lost(sample: Sample, made: Sequence[bytes], after: dict[str, bytes]) -> None:
    """Each line that only a person can have written stands somewhere still."""
    generated = {line for data in made for line in _bare(data)}
    there = "\n".join(line for data in after.values() for line in _bare(data))
    text = sample.data.removeprefix(codecs.BOM_UTF8)  # the mark stays in front
    for line, words in zip(text.split(b"\n"), _bare(text), strict=True):
        if not words or isinstance(read_marker(line.decode("utf-8", "replace"), 1), Marker):
            continue
        assert words in generated or words in there, f"lost: {words[:200]!r}"


def _bare(data: bytes) -> list[str]:
    """Return the lines of a file without any blanks."""
    return ["".join(line.decode("utf-8", "replace").split()) for line in data.split(b"\n")]


def _adopt(folder: Path) -> Made:
    from eddi_scaffold.packages.adopting.adopt import adopt

    ros = write_old_ros_package(folder / "ros", _consert_yaml())
    xdsl = _exported("PedestrianRisk.xdsl") or _exported(".xdsl")
    network = write_old_network(folder / "bn", xdsl[0].data.decode())
    sound = {p.relative_to(folder).as_posix(): p.read_bytes() for p in _files(ros, network)}
    samples = [Sample(name, data) for name, data in sound.items() if name.endswith(".py")]

    def attempt(sample: Sample) -> Steps:
        (folder / sample.name).write_bytes(sample.data)
        before = files_below(folder)
        try:
            with contextlib.suppress(EddiError):
                found = adopt(folder / sample.name.partition("/")[0], None, None)
                found.config()
            yield
            assert files_below(folder) == before, "adopt changed the old package"
        finally:
            (folder / sample.name).write_bytes(sound[sample.name])

    return samples, attempt


def _consert_yaml() -> str:
    (model, *_) = read_models(read_source(EXAMPLES / "two-conserts/two_conserts.xml")).models
    return next(iter(model.export().values()))


def _files(*folders: Path) -> Iterator[Path]:
    for folder in folders:
        yield from sorted(path for path in folder.rglob("*") if path.is_file())


_MAKERS: dict[str, Callable[[Path], Made]] = {
    "EDDI XML": _models(
        "two-conserts/two_conserts.xml", "drone/drone.xml", "pedestrian/pedestrian.xml",
        "shuttle/shuttle.xml", oracles="bn/eddi_pedestrian_fig12.xml",
    ),
    "EDDI with maps": _models(
        *(f"{MAPS}/{name}.xml" for name in ("landing", "rover_hazards", "scope")),
        "warehouse-robot/hazards.xml",
    ),
    "EDDI-Editor": _models(more=_of_eddi_editor),
    "EDDI written": _written,
    "ConSert YAML": _models(
        "robot-models/Rover.yml", "rover-events/Rover.yml", "motor-watch/drive.yml"
    ),
    "XDSL": _models(more=partial(_exported, ".xdsl")),
    "XMLBIF": _models(more=partial(_exported, ".xmlbif")),
    "BIF": _models(more=_text("n.bif", "fuzz/dogs.bif")),
    "configuration": _config,
    "deployment": _deployment,
    "reliability YAML": _models("drone/airframe.yml", more=_reliability),
    "Open-PSA": _models(more=_text("t.xml", "fuzz/tank.xml")),
    "SafeML": _safeml,
    "events": _events,
    "robot models": _robots,
    "recordings": _recordings,
    "bags": _bags,
    "answers": _answers,
    "facts": _facts,
    "sync": _sync,
    "adopt": _adopt,
}  # fmt: skip
NAMES = tuple(_MAKERS)
