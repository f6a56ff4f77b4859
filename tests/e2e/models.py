"""The example's model and configurations, and how they change in the test."""

import yaml

_PACKAGE = "//@odeProductPackages.0/@conSerts.1"
_OLD_WIRE = (
    f'<guaranteePropagation name="evidence_to_g0" source="{_PACKAGE}/@runtimeEvidence.0" '
    f'target="{_PACKAGE}/@guarantees.0"/>'
)
_NEW_WIRES = "".join(
    f'<guaranteePropagation name="{name}" source="{_PACKAGE}/{source}" '
    f'target="{_PACKAGE}/{target}"/>'
    for name, source, target in (
        ("evidence_to_and", "@runtimeEvidence.0", "@consertGates.0"),
        ("operator_to_and", "@runtimeEvidence.1", "@consertGates.0"),
        ("and_to_g0", "@consertGates.0", "@guarantees.0"),
    )
)
_NEW_EVIDENCE = """</runtimeEvidence>
      <runtimeEvidence name="RtE_A_E1" description="The operator has released system B">
        <dependabilityProperty>
          <dimension xsi:type="consert_:BinaryDimension">
            <dimensionType name="Released"/>
          </dimension>
        </dependabilityProperty>
      </runtimeEvidence>
      <consertGates name="System_B_AND" gateType="AND"/>
    </conSerts>"""


def second_model(text):
    """Return the model in which the guarantee of system B needs a second piece of evidence."""
    before, system_b = text.split('<conSerts name="ConSertB"')
    assert _OLD_WIRE in system_b
    system_b = system_b.replace(_OLD_WIRE, _NEW_WIRES)
    end = system_b.index("</conSerts>")
    start = system_b.rindex("</runtimeEvidence>", 0, end)
    system_b = system_b[:start] + _NEW_EVIDENCE + system_b[end + len("</conSerts>") :]
    return f'{before}<conSerts name="ConSertB"{system_b}'


def config_of_d72(text):
    """Return ConSertA's configuration as in D7.2 Fig 39: no ``field``, so a person writes it.

    The age that ends a guarantee is longer, so that a busy test machine loses none.
    """
    config = yaml.safe_load(text)
    demand = config["EDDIInputs"][0]
    del demand["field"]
    demand["max_age"] = 20.0
    return yaml.safe_dump(config, sort_keys=False)


def second_config(text):
    """Return ConSertB's configuration with the second piece of evidence on ``/rte/e1b``."""
    config = yaml.safe_load(text)
    config["SimulatorOutputs"].append(
        {"id": "RtE_E1", "type": "std_msgs.Bool", "topic": "/rte/e1b"}
    )
    second = {"id": "RtE_A_E1", "type": "bool", "requires": ["RtE_E1"], "max_age": "none"}
    config["EDDIInputs"].append(second)
    return yaml.safe_dump(config, sort_keys=False)
