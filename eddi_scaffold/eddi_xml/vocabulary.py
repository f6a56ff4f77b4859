"""Names of the metamodel in EDDI XML with their spellings: the place to change."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cached_property, lru_cache

_MISPRINTS = (("consent", "consert"), ("odipackage", "ddipackage"), ("allinonepkg", "allinone"))


@lru_cache(maxsize=4096)
def fold(name: str) -> str:
    """Return the form in which names are compared: no outer ``_``, no case, no known misprint."""
    folded = name.strip("_").casefold()
    for printed, intended in _MISPRINTS:
        folded = folded.replace(printed, intended)
    return folded


@lru_cache(maxsize=4096)
def local_name(tag: str) -> str:
    """Return a tag or attribute name without its namespace (``{uri}name`` or ``prefix:name``)."""
    return re.split(r"[}:]", tag)[-1]


def is_misprint(name: str) -> bool:
    """Return whether folding had to repair more than underscores and case."""
    return fold(name) != name.strip("_").casefold()


@dataclass(frozen=True)
class Spelling:
    """A name of the metamodel."""

    name: str  # the name that we write
    also: tuple[str, ...] = ()  # other names that are read without a word

    @cached_property
    def folded(self) -> frozenset[str]:
        """All accepted names, folded."""
        return frozenset(fold(name) for name in (self.name, *self.also))

    def accepts(self, name: str) -> bool:
        """Return whether a printed name means this one."""
        return fold(name) in self.folded

    def is_exact(self, name: str) -> bool:
        """Return whether a printed name is one of the accepted ones, letter by letter."""
        return name == self.name or name in self.also


@dataclass(frozen=True)
class ClassName:
    """The class of an object: package key and name, both folded."""

    package: str = ""  # last segment of the namespace URI (`failurelogic`), empty when unknown
    name: str = ""  # class name (`faulttree`), empty when the element does not give it
    printed: str = ""  # as the file has it, for messages


def package_key(uri_or_prefix: str) -> str:
    """Return the package key of a namespace: URIs of all generations give the same key."""
    return fold(re.split(r"[/#]", uri_or_prefix.rstrip("/#"))[-1])


PACKAGE_CLASS = "consertpackage"

# containment
CONSERTS = Spelling("conSerts", ("conSert",))
CONFIGURATIONS = Spelling("configurations", ("configuration",))
GUARANTEES = Spelling("guarantees", ("guarantee",))
DEMANDS = Spelling("demands", ("demand",))
EVIDENCE = Spelling("runtimeEvidence", ("runtimeEvidences",))
GATES = Spelling("consertGates", ("conSertGates", "gates", "consertGate", "gate"))
PROPAGATIONS = Spelling("guaranteePropagation", ("guaranteePropagations",))
INVARIANT = Spelling("invariant", ("invariants", "invariantOutput"))
PROPERTY_TYPES = Spelling("dependabilityPropertyTypes", ("dependabilityPropertyType",))
REQUIRED_SERVICES = Spelling("requiredServices")
PROVIDED_SERVICES = Spelling("providedServices")
ALLOCATED = Spelling("allocatedRequiredServices")
PROVIDED_ELSEWHERE = Spelling("externallyProvidedServices")
SERVICE_TYPE = Spelling("serviceType", ("functionalServiceType",))
KEY_VALUE_MAPS = Spelling("keyValueMaps", ("keyValueMap",))

# attributes
NAME = Spelling("name")
DESCRIPTION = Spelling("description")
SOURCE = Spelling("source", ("sourceElement",))
TARGET = Spelling("target", ("targetElement",))
GATE_TYPE = Spelling("gateType", ("type", "function"))
REQUIRED_SERVICE = Spelling("requiredService")
PROVIDED_SERVICE = Spelling("providedService")
DEFAULT = Spelling("isDefaultGuarantee", ("default",))
RANKING = Spelling("ranking")

# what other packages say of a ConSert and its parts; links, not content
EVENTS = Spelling("events")
REQUIREMENT = Spelling("dependabilityRequirement", ("requirements",))
SERVICE_CONFIGURATION = Spelling("serviceConfiguration")
SERVICE_CONFIGURATIONS = Spelling("serviceConfigurations")

# dimensions of SESAME
PROPERTY = Spelling("dependabilityProperty", ("dependabilityProperties",))
PROPERTY_TYPE = Spelling("dependabilityPropertyType")
DIMENSION = Spelling("dimension", ("dimensions",))
DIMENSION_TYPE = Spelling("dimensionType")
PUBLIC_TYPE = Spelling("type")
"""A child of the public metamodel; as an attribute, short for ``dimensionType``."""
COVERED = Spelling("covered")
VALUE = Spelling("value")
START = Spelling("start")
END = Spelling("end")
INCLUSIVE = Spelling("inclusive")
SUBSET = Spelling("subset")
UNIT = Spelling("unitOfMeasure", ("uom",))
PUBLIC_UNIT = Spelling("unitOfMeasurement")
NUMBER = Spelling("number")
EPSILON = Spelling("epsilon")
NUMBER_TYPE = Spelling("numberType")
RELATIONS = Spelling("demandGuaranteeDimensionRelations")
RELATION_TYPE = Spelling("dimensionRelationType")

# dimensions of the older dialect: English text
SAFETY_PROPERTIES = Spelling("safetyProperties", ("safetyProperty",))
REFINEMENT = Spelling("refinement")
INTEGRITY_LEVEL = Spelling("integrityLevel", ("asilLevel",))

# maps
KEY = Spelling("key")
VALUES = Spelling("values")

# failure logic
FAILURES, FAILURE = Spelling("failures", ("failure",)), Spelling("failure")
FAILURE_DISTRIBUTION, FAILURE_RATE = Spelling("failureProbDistribution"), Spelling("failureRate")
UNAVAILABILITY = Spelling("unavailability")
PARAMETERS, DISTRIBUTION_TYPE = Spelling("parameters", ("parameter",)), Spelling("type")
CCF_FAILURES, CAUSED_BY, IS_CCF = Spelling("ccfFailures"), Spelling("causedBy"), Spelling("isCcf")
CAUSES, CAUSE_TYPE = Spelling("causes", ("cause",)), Spelling("causeType")
ORIGIN_TYPE, TREE_GATE_TYPE = Spelling("originType"), Spelling("gateType")
TOP_EVENT = Spelling("topEvent")
CUT_SETS, SETS = Spelling("minimalCutsets"), Spelling("cutsets", ("cutset",))
SEQUENCES = Spelling("sequences")

# chains and state machines
STATES, STATE = Spelling("states", ("state",)), Spelling("state")
IS_INITIAL, IS_FAIL = Spelling("isInitialState"), Spelling("isFailState")
FAIL_STATE, INITIAL_PROBABILITY = Spelling("failState"), Spelling("initialProb")
FROM_STATES, TO_STATES = Spelling("fromStates", ("fromState",)), Spelling("toStates", ("toState",))
TRANSITIONS, TRIGGERS = Spelling("transitions", ("transition",)), Spelling("triggers", ("trigger",))
RATE = Spelling("transition")
RATE_DISTRIBUTION = Spelling("transitionProbDistribution", ("transitionProbDist",))
TRANSITION_MATRICES = Spelling("transitionMatrices")

# networks
NODES, NODE = Spelling("nodes", ("node",)), Spelling("node")
NODE_STATES = Spelling("nodeStates", ("nodeState", "states"))
NODE_STATE = Spelling("nodeState")
CONNECTIONS = Spelling("causalConnections", ("causalConnection",))
FROM, TO = Spelling("from"), Spelling("to")
ROWS = Spelling("conditionalProbabilityDistributions", ("conditionalProbabilityDistribution",))
PARENT_STATES = Spelling("parentNodeStates", ("parentNodeState",))
PROBABILITIES = Spelling("conditionalProbabilityValues", ("conditionalProbabilityValue",))
INTENTS = Spelling("inferenceIntents", ("inferenceIntent",))
REQUIRED_EVIDENCES = Spelling("requiredEvidences", ("requiredEvidence",))
INFERENCE_TARGETS = Spelling("inferenceTargets", ("inferenceTarget",))
INFERENCES = Spelling("inferences", ("inference",))
EVENT = Spelling("event")

LINKS = frozenset(
    fold(name)
    for name in (
        *("action", "actions", "dependabilityRequirement", "event", "events", "evidences"),
        *("inferenceIntent", "onEntry", "onExit", "requirements", "subModels", "triggers"),
    )
)
"""Features that refer to what no monitor needs."""
REFERENCES = LINKS.union(
    *(SOURCE.folded, TARGET.folded, REQUIRED_SERVICE.folded, PROVIDED_SERVICE.folded),
    *(SERVICE_CONFIGURATION.folded, PROPERTY_TYPE.folded, DIMENSION.folded),
    *(TOP_EVENT.folded, CAUSES.folded, FAILURES.folded, STATE.folded, FAIL_STATE.folded),
    *(CAUSED_BY.folded, CCF_FAILURES.folded, FROM_STATES.folded, TO_STATES.folded),
    *(NODE.folded, FROM.folded, TO.folded, PARENT_STATES.folded, NODE_STATE.folded),
)
"""Features of models that refer to other elements where they are attributes."""
ONE_THING = {
    name: spelling.name
    for spelling in (SOURCE, TARGET, GATE_TYPE, DEFAULT, UNIT, FROM_STATES, TO_STATES)
    for name in spelling.folded
} | {fold(PUBLIC_UNIT.name): UNIT.name}
"""Attributes -> what several of them say."""

NETWORKS = (
    'descendant-or-self::*[contains(local-name(), "ayesianNetwork") or '
    '@*[local-name() = "type" and contains(., "ayesianNetwork")]]'
)
"""XPath below a root: Bayesian networks."""

_LOWER = 'translate({0}, "FAULTREMKOVCHINS", "faultremkovchins")'
_CLASS = " or ".join(
    f'contains({_LOWER}, "{name}")' for name in ("faulttree", "markovchain", "statemachine")
)
CHAINS_AND_TREES = (
    f"self::*[{_CLASS.format('local-name()')}] | "
    f'descendant-or-self::*[@*[local-name() = "type" and ({_CLASS.format(".")})]]'
)
"""XPath at a root: chains, trees and state machines; classes are compared without case."""
