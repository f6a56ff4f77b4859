"""Classes that nobody knows: a misspelt one is named, those of other tools are left in peace."""

import pytest

from eddi_scaffold.common.files import Source
from eddi_scaffold.eddi_xml.document import read_document

TEXT = """<i:DDIPackage xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
 xmlns:f="http://www.deis-project.eu/ode/failureLogic" xmlns:a="http://x/argumentation"
 xmlns:i="http://www.deis-project.eu/ode/integration">
<odeProductPackages xsi:type="PACKAGE" name="P">
<failureModels xsi:type="MODEL" name="M"><causes xsi:type="f:Unheard"/></failureModels>
</odeProductPackages></i:DDIPackage>
"""


def said(package: str, model: str) -> list[str]:
    text = TEXT.replace("PACKAGE", package).replace("MODEL", model)
    document, problems = read_document(Source("m.xml", text.encode()))
    assert document is not None
    return [f"{p.place.line}: {p.level} {p.code} {p.message} | {p.hint}" for p in problems]


PUBLIC = """
FaultTree StateMachine BayesianNetwork FailureModel FMEA FMEDA AttackTree Action FunctionAction
MessageAction WarningAction CommonCauseFailure SecurityViolation Failure
"""
OTHERS = """
DDIPackage ConSertPackage ConSert DesignPackage System PhysicalComponent LogicalComponent Function
SafetyRelatedSystem ServiceType DependabilityPropertyType FailureLogicPackage DependabilityPackage
HARAPackage TARAPackage RequirementPackage DomainPackage TraceabilityPackage Trace Hazard Measure
RiskAssessment Malfunction DependabilityRequirement SafetyRequirement EventPackage OdeEvent
ConditionEvent ExternalEvent AssuranceCasePackage ArgumentPackage ArtifactPackage Claim
TerminologyPackage AssertedInference AssertedContext ArtifactReference
"""


def test_classes_of_the_metamodel_and_of_others_are_no_slips() -> None:
    for name in PUBLIC.split():
        assert said("f:FailureLogicPackage", f"f:{name}") == []
    for name in OTHERS.split():
        assert not [one for one in said("a:StrangePackage", f"a:{name}") if '"M"' in one]
    assert said("a:StrangePackage", "a:AssertedInference") == []
    assert said("f:FailureLogicPackage", "failurelogic_:markovchain") == []


@pytest.mark.parametrize(
    ("model", "hint"),
    [
        ("f:FaultTre", "did you mean 'FaultTree'?"),
        ("MarkovChian", "did you mean 'MarkovChain'?"),
        ("f:PetriNet", "known are: BayesianNetwork, ConSert, FaultTree, MarkovChain, StateMachine"),
    ],
)
def test_a_model_of_an_unknown_class_is_named(model: str, hint: str) -> None:
    what = f'failureModels "M" is of the unknown class "{model}", so that nothing is read from it'
    assert said("f:FailureLogicPackage", model) == [f"5: warning X006 {what} | {hint}"]


def test_a_package_of_an_unknown_class_is_named() -> None:
    (one,) = said("f:FailureLogicPakage", "f:FaultTree")
    assert one.startswith('4: warning X006 odeProductPackages "P" is of the unknown class')
    assert one.endswith("| did you mean 'FailureLogicPackage'?")
