"""Names of the ConSert extension of EDDI XML: the one place to change when the metamodel differs.

The metamodel of SESAME is not public. Containment and the names of SESAME D7.2 Figs 4 and 36 are
facts; the inner names of dimensions and the gate type are our choice. The older names are those
of the DEIS metamodel ``allInOne``. All accepted spellings are read in every dialect.
"""

from __future__ import annotations

from eddi_scaffold.readers.spelling import Spelling

PACKAGE_CLASS = "consertpackage"
CONSERT_CLASS = "consert"
SYSTEM_CLASS = "system"

# containment
CONSERTS = Spelling("conSerts", ("conSert",))
CONFIGURATIONS = Spelling("configurations", ("configuration",))
GUARANTEES = Spelling("guarantees", ("guarantee",))
DEMANDS = Spelling("demands", ("demand",))
EVIDENCE = Spelling("runtimeEvidence", ("runtimeEvidences",))
GATES = Spelling("consertGates", ("gates", "consertGate", "gate"))
PROPAGATIONS = Spelling("guaranteePropagation", ("guaranteePropagations",))
INVARIANT = Spelling("invariant", ("invariants",))
PROPERTY_TYPES = Spelling("dependabilityPropertyTypes", ("dependabilityPropertyType",))
REQUIRED_SERVICES = Spelling("requiredServices")
PROVIDED_SERVICES = Spelling("providedServices")
SERVICE_TYPE = Spelling("serviceType", ("functionalServiceType",))
KEY_VALUE_MAPS = Spelling("keyValueMaps")

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
SERVICE_DEMANDS = Spelling("demands")
SERVICE_GUARANTEES = Spelling("guarantees")

# dimensions of the SESAME extension
PROPERTY = Spelling("dependabilityProperty", ("dependabilityProperties",))
PROPERTY_TYPE = Spelling("dependabilityPropertyType")
DIMENSION = Spelling("dimension", ("dimensions",))
DIMENSION_TYPE = Spelling("dimensionType")
DIMENSION_TYPE_ATTRIBUTE = Spelling("type")
COVERED = Spelling("covered")
VALUE = Spelling("value")
START = Spelling("start")
END = Spelling("end")
INCLUSIVE = Spelling("inclusive")
SUBSET = Spelling("subset")
UNIT = Spelling("unitOfMeasure", ("uom",))

# dimensions of the older dialect: English text
SAFETY_PROPERTIES = Spelling("safetyProperties", ("safetyProperty",))
REFINEMENT = Spelling("refinement")
INTEGRITY_LEVEL = Spelling("integrityLevel", ("asilLevel",))

COMMON = (Spelling("Id"), Spelling("gid"), NAME, DESCRIPTION, KEY_VALUE_MAPS)
"""Every object of an ODE model may have these; they are known and not used."""
