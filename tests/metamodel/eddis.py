"""Random EDDIs of the public metamodel: a ConSert and a fault tree, with what they must give."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from itertools import product
from random import Random

from lxml import etree

XSI_TYPE = "{http://www.w3.org/2001/XMLSchema-instance}type"
XMI_ID = "{http://www.omg.org/XMI}id"
_SESAME, _DEIS = "http://www.sesame-project.eu/ode/", "http://www.deis-project.eu/ode/"
PACKAGES = {
    "architecture": _DEIS + "architecture",
    "consert": _SESAME + "conserts",
    "dimension": _SESAME + "dimension",
    "integration": _DEIS + "integration",
    "failureLogic": _DEIS + "failureLogic",
}
Holds = Callable[[Mapping[str, bool]], bool]
"""From which leaves are true to whether something holds."""


class Builder:
    def __init__(self, random: Random) -> None:
        self.random = random
        self.prefixes = {key: key + random.choice(["", "_", "2"]) for key in PACKAGES}
        spaces = {self.prefixes[key]: uri for key, uri in PACKAGES.items()}
        spaces |= {"xsi": XSI_TYPE[1:].partition("}")[0], "xmi": XMI_ID[1:].partition("}")[0]}
        self.root = etree.Element(f"{{{PACKAGES['integration']}}}DDIPackage", nsmap=spaces)
        self.has_ids = random.random() < 0.3
        self.links: list[tuple[etree._Element, str, list[etree._Element]]] = []

    def add(
        self, parent: etree._Element, feature: str, class_: str = "", **values: str
    ) -> etree._Element:
        child = etree.SubElement(parent, feature, **values)
        if class_:
            package, _, name = class_.partition(":")
            child.set(XSI_TYPE, f"{self.prefixes[package]}:{name}")
        return child

    def refer(self, element: etree._Element, feature: str, *targets: etree._Element) -> None:
        self.links.append((element, feature, list(targets)))

    def shuffle(self, parent: etree._Element) -> None:
        """Put features in any order; objects of one feature stay in theirs."""
        features = list(dict.fromkeys(child.tag for child in parent))
        self.random.shuffle(features)
        parent[:] = sorted(parent, key=lambda child: features.index(child.tag))

    def finish(self) -> bytes:
        for number, element in enumerate(self.root.iter() if self.has_ids else ()):
            element.set(XMI_ID, f"_{number}")
        for element, feature, targets in self.links:
            names = [t.get(XMI_ID) if self.has_ids else self._path(t) for t in targets]
            element.set(feature, " ".join(names))
        return etree.tostring(self.root, xml_declaration=True, encoding="UTF-8", pretty_print=True)

    def _path(self, element: etree._Element) -> str:
        parent = element.getparent()
        if parent is None:
            return "/"
        same = [child for child in parent if child.tag == element.tag]
        return f"{self._path(parent)}/@{element.tag}.{same.index(element)}"


@dataclass
class Eddi:
    """A file and what it must give."""

    data: bytes
    leaves: list[str]  # of the ConSert: evidence and demands
    guarantees: dict[str, Holds]  # when each holds, in order
    p_fail: float  # of the top of the tree


@dataclass
class _Graph:
    element: dict[str, etree._Element] = field(default_factory=dict)
    holds: dict[str, Holds] = field(default_factory=dict)


def random_eddi(seed: int) -> Eddi:
    random = Random(seed)
    builder = Builder(random)
    package = builder.add(builder.root, "odeProductPackages", "consert:ConSertPackage")
    leaves, guarantees = _consert(builder, package)
    package = builder.add(builder.root, "odeProductPackages", "failureLogic:FailureLogicPackage")
    p_fail = _fault_tree(builder, package)
    return Eddi(builder.finish(), leaves, guarantees, p_fail)


def _at_least(count: int, parts: Iterable[Holds]) -> Holds:
    of = tuple(parts)
    return lambda true: sum(part(true) for part in of) >= count


def _leaf(name: str) -> Holds:
    return lambda true: true[name]


def _consert(builder: Builder, package: etree._Element) -> tuple[list[str], dict[str, Holds]]:
    random = builder.random
    consert = builder.add(package, "conSerts", name="C")
    evidences, gates, edges = (
        random.choice([name, name + "s"])
        for name in (
            "runtimeEvidence",
            random.choice(["consertGate", "conSertGate"]),
            "guaranteePropagation",
        )
    )
    graph, service = _Graph(), _service(builder)
    for number in range(random.randint(1, 4)):
        name = f"L{number}"
        if random.random() < 0.3:
            graph.element[name] = builder.add(consert, "demands", name=name)
            builder.refer(graph.element[name], "requiredService", service)
        else:
            graph.element[name] = builder.add(consert, evidences, name=name)
            if random.random() < 0.6:
                _binary(builder, graph.element[name], name)
        graph.holds[name] = _leaf(name)
    leaves = list(graph.element)

    def connect(name: str, count: int) -> list[Holds]:
        sources = random.sample(list(graph.element), min(count, len(graph.element)))
        for source in sources:
            edge = builder.add(consert, edges)
            builder.refer(edge, "source", graph.element[source])
            builder.refer(edge, "target", targets[name])
        return [graph.holds[source] for source in sources]

    targets: dict[str, etree._Element] = {}
    for number in range(random.randint(0, 4)):
        name, is_or = f"G{number}", random.random() < 0.5
        targets[name] = builder.add(consert, gates, name=name)
        if is_or or random.random() < 0.5:
            targets[name].set("gateType", "OR" if is_or else "AND")
        parts = connect(name, random.randint(1, 3))
        graph.element[name] = targets[name]
        graph.holds[name] = _at_least(1 if is_or else len(parts), parts)
    found = {}
    for number in range(random.randint(1, 3)):
        name = f"Q{number}"
        targets[name] = builder.add(consert, "guarantees", name=name)
        found[name] = _at_least(1, connect(name, 1))
    if random.random() < 0.3:
        targets["I"] = builder.add(consert, "invariantOutput", name="I")
        always = _at_least(1, connect("I", 1))
        found = {name: _at_least(2, (holds, always)) for name, holds in found.items()}
    builder.shuffle(consert)
    return leaves, found


def _service(builder: Builder) -> etree._Element:
    design = builder.add(builder.root, "odeProductPackages", "architecture:DesignPackage")
    configuration = builder.add(builder.add(design, "systems", name="S"), "serviceConfigurations")
    service = builder.add(configuration, "requiredServices", name="Needs")
    builder.add(service, "serviceType", name="Type")
    return service


def _binary(builder: Builder, element: etree._Element, name: str) -> None:
    property_ = builder.add(element, "dependabilityProperty")
    dimension = builder.add(property_, "dimensions", "dimension:BinaryDimension", value="true")
    builder.add(dimension, "type", name=name)


def _fault_tree(builder: Builder, package: etree._Element) -> float:
    random = builder.random
    tree = builder.add(package, "failureModels", "failureLogic:FaultTree", name="T")
    graph, laws, failures = _Graph(), {}, {}
    for number in range(random.randint(1, 5)):
        name = f"E{number}"
        laws[name] = round(random.random(), 3) or 0.5
        failures[name] = _failure(builder, tree, f"{name} failure", laws[name])
        type_ = random.choice(["BasicEvent", "NormalEvent"])
        graph.element[name] = builder.add(tree, "causes", name=name, causeType=type_)
        builder.refer(graph.element[name], "failure", failures[name])
        graph.holds[name] = _leaf(name)
    if len(laws) > 1 and random.random() < 0.4:
        _common_cause(builder, tree, graph, laws, failures)
    for number in range(random.randint(1, 4)):
        name = f"T{number}"
        of = random.sample(list(graph.element), random.randint(1, min(3, len(graph.element))))
        type_ = random.choice(["OR", "AND", "VOTE"])
        needed = {"OR": 1, "AND": len(of)}.get(type_, random.randint(1, len(of)))
        gate = builder.add(tree, "causes", "failureLogic:Gate", name=name, causeType="Gate")
        if type_ != "OR" or random.random() < 0.5:
            gate.set("gateType", type_)
        if type_ == "VOTE":
            builder.add(builder.add(gate, "keyValueMaps", key="k"), "values", value=str(needed))
        builder.refer(gate, "causes", *(graph.element[one] for one in of))
        holds = _at_least(needed, [graph.holds[one] for one in of])
        graph.element[name], graph.holds[name] = gate, holds
    builder.refer(tree, "topEvent", gate)
    builder.shuffle(tree)
    total = 0.0
    for world in product([False, True], repeat=len(laws)):
        true = dict(zip(laws, world, strict=True))
        if holds(true):
            weight = 1.0
            for name, happens in true.items():
                weight *= laws[name] if happens else 1.0 - laws[name]
            total += weight
    return total


def _failure(
    builder: Builder, tree: etree._Element, name: str, p: float, class_: str = ""
) -> etree._Element:
    failure = builder.add(tree, "failures", class_, name=name)
    law = builder.add(failure, "failureProbDistribution", type="Fixed")
    builder.add(law, "parameters", name="p", value=repr(p))
    return failure


def _common_cause(
    builder: Builder,
    tree: etree._Element,
    graph: _Graph,
    laws: dict[str, float],
    failures: dict[str, etree._Element],
) -> None:
    """Add a cause that some of the events have in common, said at either end or at both."""
    members = builder.random.sample(list(laws), 2)
    laws["X"] = 0.125
    cause = _failure(builder, tree, "X", laws["X"], "failureLogic:CommonCauseFailure")
    said = builder.random.choice(["members", "cause", "both"])
    if said != "cause":
        builder.refer(cause, "ccfFailures", *(failures[name] for name in members))
    for name in members:
        if said != "members":
            builder.refer(failures[name], "causedBy", cause)
        graph.holds[name] = _at_least(1, [_leaf(name), _leaf("X")])
