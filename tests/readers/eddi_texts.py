"""Small EDDI files of our own, and ways to read them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from eddi_scaffold.kinds.consert.from_eddi import read_eddi
from eddi_scaffold.problems import in_order
from eddi_scaffold.readers.eddi import read_document
from eddi_scaffold.readers.survey import survey
from eddi_scaffold.source import Source

if TYPE_CHECKING:
    from collections.abc import Iterable

    from eddi_scaffold.kinds.consert.model import ConSert
    from eddi_scaffold.problems import Problem

ROVER = """<?xml version="1.0" encoding="UTF-8"?>
<integration_:DDIPackage xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xmlns:architecture_="http://www.deis-project.eu/ode/architecture" xmlns:consert_="http://www.deis-project.eu/ode/consert" xmlns:integration_="http://www.deis-project.eu/ode/integration" name="Rover">
  <odeProductPackages xsi:type="consert_:ConSertPackage" name="Certificates">
    <conSerts name="Drive">
      <guaranteePropagation source="//@odeProductPackages.0/@conSerts.0/@runtimeEvidence.0 //@odeProductPackages.0/@conSerts.0/@demands.0" target="//@odeProductPackages.0/@conSerts.0/@consertGates.0"/>
      <guaranteePropagation source="//@odeProductPackages.0/@conSerts.0/@consertGates.0" target="//@odeProductPackages.0/@conSerts.0/@guarantees.0"/>
      <guaranteePropagation source="//@odeProductPackages.0/@conSerts.0/@runtimeEvidence.1" target="//@odeProductPackages.0/@conSerts.0/@guarantees.1"/>
      <demands name="free_path" description="the map says so" requiredService="//@odeProductPackages.1/@systems.0/@serviceConfigurations.0/@requiredServices.0">
        <dependabilityProperty dependabilityPropertyType="//@odeProductPackages.0/@dependabilityPropertyTypes.0">
          <dimension xsi:type="consert_:NumericDimension" subset="Demand" unitOfMeasure="m">
            <dimensionType name="FreePath"/>
            <covered start="2.50" end="INF" inclusive="true"/>
          </dimension>
        </dependabilityProperty>
      </demands>
      <guarantees name="fast" ranking="1" providedService="//@odeProductPackages.1/@systems.0/@serviceConfigurations.0/@providedServices.0">
        <dependabilityProperty>
          <dimension xsi:type="consert_:CategoricalDimension" subset="Guarantee">
            <dimensionType name="Speed"/>
            <covered value="slow"/>
            <covered value="fast"/>
          </dimension>
          <dimension xsi:type="consert_:BinaryDimension">
            <dimensionType name="Moves"/>
          </dimension>
        </dependabilityProperty>
      </guarantees>
      <guarantees name="slow" ranking="2" providedService="//@odeProductPackages.1/@systems.0/@serviceConfigurations.0/@providedServices.0">
        <dependabilityProperty>
          <dimension xsi:type="consert_:CategoricalDimension" subset="Guarantee">
            <dimensionType name="Speed"/>
            <covered value="slow"/>
          </dimension>
        </dependabilityProperty>
      </guarantees>
      <runtimeEvidence name="battery">
        <dependabilityProperty>
          <dimension xsi:type="consert_:NumericDimension" subset="Guarantee" unitOfMeasure="">
            <dimensionType name="Charge"/>
            <covered start="0.2" end="1" inclusive="false"/>
          </dimension>
        </dependabilityProperty>
      </runtimeEvidence>
      <runtimeEvidence name="brakes">
        <dependabilityProperty>
          <dimension xsi:type="consert_:BinaryDimension">
            <dimensionType name="BrakesWork"/>
          </dimension>
        </dependabilityProperty>
      </runtimeEvidence>
      <consertGates name="both" gateType="AND"/>
    </conSerts>
    <dependabilityPropertyTypes name="Distance"/>
  </odeProductPackages>
  <odeProductPackages xsi:type="architecture_:DesignPackage">
    <systems name="Rover">
      <serviceConfigurations name="Normal">
        <providedServices name="Driving">
          <serviceType name="DrivingType"/>
        </providedServices>
        <requiredServices name="Mapping">
          <serviceType name="MappingType"/>
        </requiredServices>
      </serviceConfigurations>
    </systems>
  </odeProductPackages>
</integration_:DDIPackage>
"""

OLDER = """<?xml version="1.0" encoding="ASCII"?>
<allInOne:System xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xmlns:allInOne="allInOnePkg" name="Truck">
  <configurations name="C1" configurationRanking="1">
    <conSert name="Follower">
      <guarantees name="keeps_gap" ranking="1">
        <safetyProperties><refinement name="Gap bound to &lt;= 12.5 m: ASIL B"/></safetyProperties>
      </guarantees>
      <guarantees name="stops" isDefaultGuarantee="true">
        <safetyProperties><refinement name="vehicle stops"/></safetyProperties>
      </guarantees>
      <demands name="leader_speed">
        <safetyProperties><refinement name="Speed deviation &lt; 2 km/h"/></safetyProperties>
      </demands>
      <runtimeEvidence name="radio" description="Radio delay bound to &lt; 300 ms"/>
      <runtimeEvidence name="radar" description="Radar is healthy"/>
      <gates name="all"/>
      <guaranteePropagations sourceElement="//@configurations.0/@conSert/@runtimeEvidence.0" targetElement="//@configurations.0/@conSert/@gates.0"/>
      <guaranteePropagations sourceElement="//@configurations.0/@conSert/@demands.0" targetElement="//@configurations.0/@conSert/@gates.0"/>
      <guaranteePropagations sourceElement="//@configurations.0/@conSert/@gates.0" targetElement="//@configurations.0/@conSert/@guarantees.0"/>
      <guaranteePropagations sourceElement="//@configurations.0/@conSert/@runtimeEvidence.1" targetElement="//@configurations.0/@conSert/@guarantees.0"/>
    </conSert>
    <providedServices name="Follow" guarantees="//@configurations.0/@conSert/@guarantees.0 //@configurations.0/@conSert/@guarantees.1"><functionalServiceType name="Following"/></providedServices>
    <requiredServices name="Lead" demands="//@configurations.0/@conSert/@demands.0"><functionalServiceType name="Leading"/></requiredServices>
  </configurations>
</allInOne:System>
"""

SAFETY_CASE = """<?xml version="1.0" encoding="UTF-8"?>
<integration:DDIPackage xmlns:xmi="http://www.omg.org/XMI" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xmlns:integration="http://www.deis-project.eu/ode/mergedODE/integration" xmlns:failureLogic="http://www.deis-project.eu/ode/mergedODE/failureLogic" xmlns:argumentation="http://www.deis-project.eu/ode/mergedODE/sacm/argumentation">
  <odeProductPackages xsi:type="failureLogic:FailureLogicPackage">
    <failureModels xsi:type="failureLogic:FMEA" name="Effects"><failures name="F"/><entries mode="//@odeProductPackages.0/@failureModels.0/@failures.0"/></failureModels>
    <failureModels name="Plain"><failures name="F"/><failures name="G"/></failureModels>
  </odeProductPackages>
  <assuranceCasePackages gid="case">
    <name content="The case"/>
    <argumentPackages>
      <argumentationElement xsi:type="argumentation:Claim" gid="G1"><name content="safe"/>free text</argumentationElement>
      <argumentationElement xsi:type="argumentation:ArtifactReference" gid="Sn1"/>
      <argumentationElement xsi:type="argumentation:AssertedInference" source="//@assuranceCasePackages.0/@argumentPackages.0/@argumentationElement.1" target="//@assuranceCasePackages.0/@argumentPackages.0/@argumentationElement.9"/>
    </argumentPackages>
  </assuranceCasePackages>
</integration:DDIPackage>
"""


def read(data: bytes | str, *marks: str) -> tuple[tuple[ConSert, ...], list[Problem]]:
    """Read the ConSerts of a file called m.xml, and survey it, as the commands do."""
    source = Source("m.xml", data.encode() if isinstance(data, str) else data)
    document, problems = read_document(source)
    if document is None:
        return (), in_order(problems)
    survey(document).as_json()
    conserts, more = read_eddi(document, source, marks)
    return conserts, in_order([*problems, *more])


def texts(problems: Iterable[Problem]) -> list[str]:
    """Return problems as one line each; the path of the element is not in it."""
    return [
        f"{p.place.file}:{p.place.line}: {p.level} {p.code}: {p.message}" for p in in_order(problems)
    ]


def codes(problems: Iterable[Problem]) -> set[str]:
    """Return the codes of the problems."""
    return {p.code for p in problems}
