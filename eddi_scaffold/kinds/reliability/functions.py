"""The functions of the kind: reading, checks and reports."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from eddi_scaffold.common.claims import Claim, Element
from eddi_scaffold.common.files import Source, next_to, read_source
from eddi_scaffold.common.problems import EddiError, Place, Problem, has_errors, in_order, problem
from eddi_scaffold.compiling.monitor import BoundInput, CompiledMonitor, Declaration
from eddi_scaffold.diagrams import Diagram
from eddi_scaffold.eddi_xml.document import EddiDocument
from eddi_scaffold.eddi_xml.parsing import load
from eddi_scaffold.eddi_xml.reading import read_document
from eddi_scaffold.kinds import Functions, ModelInput, ModelOutput, Options, ReadResult, Skeleton
from eddi_scaffold.kinds.reliability import read_eddi as from_eddi
from eddi_scaffold.kinds.reliability import show
from eddi_scaffold.kinds.reliability.checks import check_system
from eddi_scaffold.kinds.reliability.claims import MEANINGS
from eddi_scaffold.kinds.reliability.compile import compile_system
from eddi_scaffold.kinds.reliability.inputs import inputs_of
from eddi_scaffold.kinds.reliability.lowering import used
from eddi_scaffold.kinds.reliability.read_open_psa import read_mef
from eddi_scaffold.kinds.reliability.read_yaml import KEYS, read_system, with_rate
from eddi_scaffold.kinds.reliability.show import picture
from eddi_scaffold.kinds.reliability.skeleton import decided, drafted
from eddi_scaffold.kinds.reliability.system import NAME, ReliabilityModel, ReliabilitySystem, order
from eddi_scaffold.kinds.reliability.trial import at_start
from eddi_scaffold.kinds.reliability.values import KEY, Values
from eddi_scaffold.kinds.reliability.write import to_mef, to_yaml
from eddi_scaffold.yaml_text.nodes import Items, Map, Node, read_map, value_11


def read_eddi(document: EddiDocument, source: Source, _: Sequence[str]) -> ReadResult:
    """Read the chains and the top events of an EDDI, one model each."""
    systems, problems = from_eddi.read_eddi(document, source)
    if has_errors(problems):
        return ReadResult((), tuple(problems))
    models = tuple(
        ReliabilityModel(NAME, system.top, system, source, system.place) for system in systems
    )
    return ReadResult(models, tuple(problems))


def read_file(source: Source, _: Sequence[str]) -> ReadResult:
    """Read ``reliability_config.yml`` and the EDDI that it may name, or an Open-PSA file."""
    if not source.name.lower().endswith((".yml", ".yaml")):
        return _read_mef(source)
    root, problems = read_map(source, "R001")
    if root is None or has_errors(problems):
        return ReadResult((), tuple(in_order(problems)))
    values = Values(value_11(root), _finder(root), problems=problems)
    library = _library(values, source)
    system, problems = read_system(values, library, None)
    if system is None:
        return ReadResult((), tuple(in_order(problems)))
    model = ReliabilityModel(NAME, source.stem, system, source, root.place)
    return ReadResult((model,), tuple(in_order(problems)))


def _read_mef(source: Source) -> ReadResult:
    with source.open() as stream:
        tree, problems = load(stream, source.name)
    if tree is None:
        return ReadResult((), tuple(problems))
    systems, found = read_mef(tree.document, source.name, source.stem)
    models = tuple(
        ReliabilityModel(NAME, system.top, system, source, system.place) for system in systems
    )
    return ReadResult(models, tuple(in_order([*problems, *found])))


def _finder(root: Node) -> Callable[..., Place]:
    def find(*path: str | int) -> Place:
        node = root
        for i, step in enumerate(path):
            below: Node | None = None
            if isinstance(node, Map):
                below = node.get(str(step))
                if path[i + 1 :] == (KEY,):
                    return next((k.place for k, _ in node.entries if k.text == step), node.place)
            elif isinstance(node, Items) and isinstance(step, int) and step < len(node.items):
                below = node.items[step]
            if below is None:
                break
            node = below
        return node.place

    return find


def _library(values: Values, source: Source) -> Mapping[str, ReliabilitySystem]:
    """Read the EDDI that the key ``file`` names, relative to the configuration."""
    name = values.text("file")
    if name is None:
        return {}
    try:
        eddi = read_source(next_to(source.name, name))
    except EddiError as failure:
        reasons = "; ".join(problem.message for problem in failure.problems)
        values.report("R001.file", "file", name=name, reasons=reasons)
        return {}
    document, problems = read_document(eddi)
    values.problems += problems
    if document is None:
        return {}
    systems, problems = from_eddi.read_eddi(document, eddi)
    values.problems += problems
    return {system.top: system for system in systems}


def configure(
    model: ReliabilityModel, options: Options
) -> tuple[ReliabilityModel | None, list[Problem]]:
    """Take the keys of ``Model:`` into the system: horizon, thresholds, what is observed."""
    system: ReliabilitySystem | None = model.data
    given = {key: value for key, value in options.values.items() if key in KEYS}
    problems: list[Problem] = []
    if given:
        values = Values(given, options.place)
        system, problems = read_system(values, {}, system)
    if system is None:
        return None, problems
    system = used(with_rate(system, options.frequency)) if not _broken(system) else system
    # what was in the file before is reported by check
    before = set(check(model))
    problems += [one for one in check_system(system) if one.level == "error" or one not in before]
    if has_errors(problems):
        return None, problems
    problems += [one for one in _never(system) if one not in before]
    problems += _always_late(system)
    return replace(model, data=system, name=options.id or model.name), problems


def _broken(system: ReliabilitySystem) -> bool:
    return has_errors(check_system(system))


def _always_late(system: ReliabilitySystem) -> list[Problem]:
    """Return a warning when every step comes later than is usual (R014)."""
    if system.max_gap is None or system.max_gap >= system.quantum:
        return []
    return [problem("R014.max_gap", system.place, max_gap=system.max_gap, period=system.quantum)]


def _never(system: ReliabilitySystem) -> list[Problem]:
    """Return a warning for each threshold that decides nothing at the start (R014).

    Where the mission's end is an input, the best is that it comes at once.
    """
    if not system.thresholds:
        return []
    best = at_start(system, seconds_left=0.0 if system.mission_end else None)
    worst = at_start(system, known=False)
    when = "at mission start" + (", however near the end is" if system.mission_end else "")
    found = []
    for threshold in system.thresholds:
        if best.p_fail > threshold.activate:
            found.append(
                problem(
                    "R014.never_met",
                    threshold.place,
                    threshold=threshold.id,
                    when=when,
                    p_fail=best.p_fail,
                    activate=threshold.activate,
                )
            )
        elif worst.p_fail_high <= threshold.activate and inputs_of(system):
            found.append(
                problem(
                    "R014.always_met",
                    threshold.place,
                    threshold=threshold.id,
                    p_fail_high=worst.p_fail_high,
                )
            )
    return found


def check(model: ReliabilityModel) -> Sequence[Problem]:
    """Return what is wrong with the models, regardless of the configuration."""
    system = model.data
    problems = check_system(system)
    return problems if has_errors(problems) else [*problems, *_never(system)]


def inputs(model: ReliabilityModel) -> Sequence[ModelInput]:
    """Return the inputs that the monitor needs."""
    return inputs_of(used(model.data))


def skeleton(model: ReliabilityModel, options: Options) -> Skeleton:
    """Return what a configuration with these options has still to say."""
    configured, _ = configure(model, replace(options, values=decided(options.values)))
    return drafted(model, configured)


def outputs(model: ReliabilityModel) -> Sequence[ModelOutput]:
    """Return the topics of thresholds that have one."""
    return [
        ModelOutput(
            threshold.id,
            threshold.topic,
            ("evidence", ("id", threshold.id), "active"),
            threshold.place,
        )
        for threshold in model.data.thresholds
        if threshold.topic is not None
    ]


def ids(model: ReliabilityModel) -> Mapping[str, Sequence[str]]:
    """Return the thresholds that the message contains."""
    return {"evidence": [threshold.id for threshold in model.data.thresholds]}


def export(model: ReliabilityModel) -> Mapping[str, str]:
    """Return the whole system as one readable file, and its tree as Open-PSA where that can be."""
    name = "".join(c if c.isalnum() or c in "._-" else "_" for c in model.name)
    tree = to_mef(model.data)
    opsa = {f"{name}.opsa.xml": tree} if tree is not None else {}
    return {f"{name}.yml": to_yaml(model.data), **opsa}


def counts(model: ReliabilityModel) -> Mapping[str, int]:
    """Return what ``show`` counts."""
    return show.counts(model.data)


def outline(model: ReliabilityModel) -> Sequence[str]:
    """Return the lines that ``show`` prints."""
    return show.outline(model.data)


def readme(model: ReliabilityModel) -> Sequence[str]:
    """Return lines of Markdown for the package's README."""
    return show.readme(model.data)


def diagram(model: ReliabilityModel) -> Diagram:
    """Return the picture of the chains and trees."""
    return picture(model.name, model.data)


def compile_model(model: ReliabilityModel, declaration: Declaration) -> CompiledMonitor:
    """Return the compiled monitor."""
    return compile_system(model.data, declaration)


def claims(
    model: ReliabilityModel, bound: Sequence[BoundInput], _frequency: float
) -> Sequence[Claim]:
    """Return the thresholds: every input counts in the probability of failure."""
    inputs_of_model = frozenset(input_.id for input_ in bound)
    return [Claim(threshold.id, inputs_of_model) for threshold in model.data.thresholds]


def elements(model: ReliabilityModel) -> Sequence[Element]:
    """Return what the top uses, each behind what it needs, then the thresholds."""
    components = model.data.components
    below = {name: component.below for name, component in components.items()}
    names = (name for name in order(model.data.top, below)[0] if name in components)
    places = [(name, components[name].place) for name in names]
    return [
        *(Element("component", name, None, place.line, place.path) for name, place in places),
        *(Element("threshold", threshold.id) for threshold in model.data.thresholds),
    ]


FUNCTIONS = Functions(
    read_eddi=read_eddi,
    read_file=read_file,
    check=check,
    counts=counts,
    outline=outline,
    export=export,
    inputs=inputs,
    outputs=outputs,
    configure=configure,
    readme=readme,
    diagram=diagram,
    ids=ids,
    elements=elements,
    skeleton=skeleton,
    compile=compile_model,
    claims=claims,
    field_meanings=lambda _claims: MEANINGS,
)
"""What is done with systems of chains and trees."""
