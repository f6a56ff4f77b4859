"""Options of a network in a configuration: outputs, observed nodes, evidence, discretisation."""

from __future__ import annotations

from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from eddi_scaffold.common.claims import Use
from eddi_scaffold.common.identifiers import attribute, free_name
from eddi_scaffold.common.problems import Problem, did_you_mean, has_errors, problem
from eddi_scaffold.common.units import accepted
from eddi_scaffold.kinds import InputType, ModelInput, Options
from eddi_scaffold.kinds.bayesian_network.discretisation import Declaration, read_discretisation
from eddi_scaffold.kinds.bayesian_network.influence import doubts, without_influence
from eddi_scaffold.kinds.bayesian_network.network import Network, in_digits, node_attributes
from eddi_scaffold.kinds.bayesian_network.structure import shape_of
from eddi_scaffold.kinds.bayesian_network.thresholds import Threshold, read_thresholds
from eddi_scaffold.kinds.bayesian_network.width import LARGE, TOO_LARGE, Width, width_of

_CHOICES = {"evidence_mode": ("virtual", "d7.2"), "on_inconsistent": ("silent", "prior", "hold")}


@dataclass(frozen=True)
class NetworkOptions:
    """A network's use, checked.

    Attributes:
        outputs: nodes whose posteriors are given, in the order of the network.
        observed: nodes that inputs feed or `observed:` names, in the order of the network.
        foreseen: what `observed:` names, `None` without it.
        by_hand: nodes that a person can make of inputs which feed none.
        declarations: discretised nodes.
        direct: node -> input that holds its state or likelihoods.
        inputs: what the monitor reads.
        renamed: node -> its former name; its hand-written body moves along.
        virtual: several non-zero outcomes are likelihoods; else D7.2's rule.
        on_inconsistent: the result on evidence of probability zero.
        explain: the status message has the relevance of each observed node.
        width: what inference will cost.
        thresholds: the evidence for ConSerts.
    """

    outputs: tuple[str, ...]
    observed: tuple[str, ...]
    declarations: tuple[Declaration, ...]
    direct: Mapping[str, str]
    inputs: tuple[ModelInput, ...] = field(compare=False)
    width: Width = field(compare=False)
    foreseen: tuple[str, ...] | None = None
    renamed: Mapping[str, str] = field(default_factory=dict, compare=False)
    virtual: bool = True
    on_inconsistent: str = "silent"
    explain: bool = False
    thresholds: tuple[Threshold, ...] = ()
    by_hand: tuple[str, ...] = ()

    @property
    def inferred(self) -> tuple[str, ...]:
        """The nodes whose posteriors are computed: the outputs, and what evidence is made of."""
        return tuple(
            dict.fromkeys([*self.outputs, *(threshold.node for threshold in self.thresholds)])
        )

    @property
    def observable(self) -> tuple[str, ...]:
        """The nodes that may be observed: those that `observed:` names, or that inputs feed."""
        return self.observed if self.foreseen is None else self.foreseen


def read_options(network: Network, options: Options) -> tuple[NetworkOptions | None, list[Problem]]:
    """Read what a configuration says of a network (B301 to B305, B401 to B405)."""
    settings, problems = _settings(network, options)
    if settings is not None:
        problems += _too_wide(settings.width, options)
        problems += without_influence(network, settings.inferred, settings.observed, options)
    return None if has_errors(problems) else settings, problems


def _settings(network: Network, options: Options) -> tuple[NetworkOptions | None, list[Problem]]:
    """Return the settings, also of a network that is too wide for them."""
    declarations, problems = read_discretisation(network, options)
    problems += _wrong_choices(options)
    discretised = {declaration.node for declaration in declarations}
    thresholds, wrong = read_thresholds(network, options, discretised)
    problems += wrong
    direct = _direct(network, options, declarations)
    inputs = _with_uses(_apart(_inputs(network, options, declarations, direct)), declarations)
    if thresholds:
        inputs = _judged_by_default(inputs, {*direct.values(), *(d.input for d in declarations)})
    foreseen = _named(network, options, "observed", problems)
    fed = discretised | set(direct) | set(foreseen or ())
    observed = [node for node in network.names() if node in fed]
    outputs = _outputs(network, options, observed, problems)
    renamed = _renamed(network, options, problems)
    if has_errors(problems):
        return None, problems
    judged, names = [*outputs, *(threshold.node for threshold in thresholds)], network.names()
    problems += doubts(network, thresholds, declarations, observed, options)
    values = options.values
    declared = {*discretised, *direct}
    spare = {input_.id for input_ in inputs}.difference(
        direct.values(), (d.input for d in declarations)
    )
    may_be = foreseen if foreseen is not None else [n for n in network.names() if n not in outputs]
    by_hand = [node for node in may_be if node not in declared] if spare else ()
    settings = NetworkOptions(
        tuple(outputs),
        tuple(observed),
        tuple(declarations),
        direct,
        inputs,
        width_of(
            shape_of(network),
            [names.index(node) for node in judged],
            [names.index(node) for node in (observed if foreseen is None else foreseen)],
        ),
        None if foreseen is None else tuple(foreseen),
        renamed,
        values.get("evidence_mode") != "d7.2",
        str(values.get("on_inconsistent", "silent")),
        values.get("explain") is True,
        tuple(thresholds),
        tuple(by_hand),
    )
    return settings, problems


def default_options(network: Network) -> NetworkOptions:
    """Return the settings without a configuration."""
    settings, _ = _settings(network, Options())
    assert settings is not None, "a checked network needs no configuration"
    return settings


def _wrong_choices(options: Options) -> Iterable[Problem]:
    for key, known in _CHOICES.items():
        value = options.values.get(key, known[0])
        if value not in known:
            yield problem("B404.option", options.place(key), key=key, allowed=" or ".join(known))
    if not isinstance(options.values.get("explain", False), bool):
        yield problem("B404.explain", options.place("explain"))


def _direct(
    network: Network, options: Options, declarations: Sequence[Declaration]
) -> dict[str, str]:
    """Return node -> input for inputs that are called as a node, or as its identifier."""
    taken = {declaration.input for declaration in declarations}
    declared = {declaration.node for declaration in declarations}
    attributes = node_attributes(network)
    if not options.inputs and not declarations:
        return {name: name for name in network.names()}
    ids = {input_.id for input_ in options.inputs} - taken
    found = {}
    for name in network.names():
        chosen = name if name in ids else attributes[name]
        if name not in declared and chosen in ids:
            found[name] = chosen
    return found


def _inputs(
    network: Network,
    options: Options,
    declarations: Sequence[Declaration],
    direct: Mapping[str, str],
) -> tuple[ModelInput, ...]:
    """Return the inputs in the order of the configuration, else one for each node."""
    if not options.inputs:
        return tuple(_direct_input(network, node, name) for node, name in direct.items())
    by_input = {declaration.input: declaration for declaration in reversed(declarations)}
    of_direct = {name: node for node, name in direct.items()}
    found = []
    for input_ in options.inputs:
        if input_.id in of_direct:
            found.append(_direct_input(network, of_direct[input_.id], input_.id))
        elif input_.id in by_input:
            declared = by_input[input_.id]
            text = f"becomes a state of {declared.node}"
            found.append(_input(input_.id, declared.type, input_.unit, text))
        else:
            text = "for the methods in bayesian_network_config.py"
            found.append(_input(input_.id, input_.type or "float", input_.unit, text))
    return tuple(found)


def _apart(inputs: Sequence[ModelInput]) -> tuple[ModelInput, ...]:
    """Keep inputs apart whose ids look alike in Python (``CO2 report``, ``CO2_report``)."""
    taken: set[str] = set()
    found = []
    for input_ in inputs:
        wanted = attribute(input_.id)
        name = free_name(wanted, taken)
        taken.add(name)
        found.append(input_ if name == wanted else replace(input_, attribute=name))
    return tuple(found)


def _judged_by_default(
    inputs: Sequence[ModelInput], feeding: Container[str]
) -> tuple[ModelInput, ...]:
    """Declare that any default of what feeds a node may make evidence active before a message."""
    return tuple(
        replace(input_, is_good=lambda _: True) if input_.id in feeding else input_
        for input_ in inputs
    )


def _with_uses(
    inputs: Sequence[ModelInput], declarations: Sequence[Declaration]
) -> tuple[ModelInput, ...]:
    """Set for mapped inputs which values are observations: the others leave a node open."""
    mapped = {
        declaration.input: [value for value, _ in declaration.data["map"]]
        for declaration in declarations
        if "map" in declaration.data and "bins" not in declaration.data
    }
    return tuple(
        replace(input_, uses=(Use(mapped[input_.id].__contains__),))
        if input_.id in mapped
        else input_
        for input_ in inputs
    )


def _direct_input(network: Network, node: str, name: str) -> ModelInput:
    states = ", ".join(network.node(node).states)
    return ModelInput(name, "state", description=f"a state of {node} ({states}), or likelihoods")


def _input(name: str, of: InputType, unit: str | None, text: str) -> ModelInput:
    return ModelInput(name, of, unit=unit, units=accepted(unit), description=text)


def _named(
    network: Network, options: Options, key: str, problems: list[Problem]
) -> list[str] | None:
    given = options.values.get(key)
    if given is None:
        return None
    if not isinstance(given, list):
        problems.append(problem("B303.nodes_list", options.place(key), key=key))
        return []
    names = network.names()
    for number, name in enumerate(given):
        if name not in names:
            hint = did_you_mean(str(name), names)
            problems.append(
                problem(
                    "B303.unknown_node", options.place(key, number), hint=hint, key=key, name=name
                )
            )
    return [name for name in names if name in given]


def _outputs(
    network: Network, options: Options, observed: Sequence[str], problems: list[Problem]
) -> list[str]:
    given = _named(network, options, "outputs", problems)
    if given is not None:
        if not given and not has_errors(problems):
            problems.append(problem("B303.no_output", options.place("outputs")))
        return given
    marked = [node.id for node in network.nodes if node.target]
    if marked:
        return marked
    children = network.children()
    leaves = [name for name in network.names() if not children[name]]
    unseen = [name for name in leaves if name not in observed]
    return unseen or leaves


def _renamed(network: Network, options: Options, problems: list[Problem]) -> dict[str, str]:
    given = options.values.get("renamed", {})
    if not isinstance(given, Mapping):
        problems.append(problem("B404.renamed", options.place("renamed")))
        return {}
    names = network.names()
    problems += [
        problem("B303.renamed_node", options.place("renamed", name), name=name)
        for name in given
        if name not in names
    ]
    return {str(new): str(old) for new, old in given.items()}


def _too_wide(width: Width, options: Options) -> Iterable[Problem]:
    if width.largest <= LARGE:
        return
    shown = ", ".join(width.nodes[:8]) + (", ..." if len(width.nodes) > 8 else "")
    yield problem(
        "B301.too_large" if width.too_large else "B301.large",
        options.place(),
        entries=in_digits(width.largest),
        limit=TOO_LARGE if width.too_large else LARGE,
        nodes=shown,
    )
