"""How model, configurations, code and templates of the example change in the test.

What a person writes into EDDIInput.py is that of D7.2 Figs 43 and 44, and a little more.
"""

import ast

import yaml

from tests.checkouts import git
from tests.data_files import data_text

# Newer than any release of the checkout: copier takes the newest tag.
FIRST, SECOND = "v900.0.0", "v900.1.0"
_STAGE = "copier_templates/ros1_monitor/.eddi/new/{{ stage }}"
_SECOND_LOOK = {
    "copier_templates/eddi_input.py.jinja": (
        '"""One attribute for each input; it is unknown',
        '"""One attribute, second version, for each input; it is unknown',
    ),
    f"{_STAGE}/scripts/RosNode.py.jinja": (
        '"""ROS 1 node of the monitor',
        '"""The second version of the ROS 1 node of the monitor',
    ),
    f"{_STAGE}/CMakeLists.txt.jinja": (
        "catkin_package()\n",
        "catkin_package()  # second version\n",
    ),
}
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
_NEW_EVIDENCE = data_text("e2e/new_evidence.txt")
_INDENT = " " * 8
_HELPER = (
    "def is_healthy(message):",
    '    """Written by hand, beside the class."""',
    "    return message.data is True",
)
_DEMAND = ("self.RtE_A_D0 = consertb.guarantees[0].active",)
_EVIDENCE_A = ("self.RtE_A_E0 = is_healthy(RtE_E0)",)
_EVIDENCE_B = (
    "if RtE_E0.data and not self.RtE_A_E0:",
    "    print('system B: written by hand')",
    "self.RtE_A_E0 = RtE_E0.data",
)
SEEN_AT_RUN_TIME = "system B: written by hand"


def release_second_version(clone):
    """Change texts in an editable and in two generated files, and tag that."""
    for name, (old, new) in _SECOND_LOOK.items():
        text = (clone.path / name).read_text()
        assert text.count(old) == 1, (name, old)
        (clone.path / name).write_text(text.replace(old, new))
    git(clone.path, "commit", "--quiet", "--all", "--message", "Second version")
    git(clone.path, "tag", SECOND)


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
    config = yaml.safe_load(of_each_robot(text))
    demand = config["EDDIInputs"][0]
    del demand["field"]
    demand["max_age"] = 20.0
    return yaml.safe_dump(config, sort_keys=False)


def of_each_robot(text):
    """Return a configuration whose sensors are those of the robot on which the monitor runs."""
    return text.replace("topic: /rte", "topic: rte")


def second_config(text):
    """Return ConSertB's configuration with the second piece of evidence on ``rte/e1b``."""
    config = yaml.safe_load(of_each_robot(text))
    config["SimulatorOutputs"].append({"id": "RtE_E1", "type": "std_msgs.Bool", "topic": "rte/e1b"})
    second = {"id": "RtE_A_E1", "type": "bool", "requires": ["RtE_E1"], "max_age": "none"}
    config["EDDIInputs"].append(second)
    return yaml.safe_dump(config, sort_keys=False)


def write_by_hand(path_a, path_b):
    """Write the demand and the evidence of both systems, one through a function of one's own."""
    _write_region(path_a, "process_RtE_A_D0", _DEMAND)
    _write_region(path_a, "process_RtE_A_E0", _EVIDENCE_A)
    _write_region(path_a, "EDDIInput.module", _HELPER, "")
    _write_region(path_b, "process_RtE_A_E0", _EVIDENCE_B)


def _write_region(path, region, lines, indent=_INDENT):
    text = path.read_text().splitlines()
    marks = [i for i, line in enumerate(text) if f"# region: {region} " in f"{line} "]
    assert len(marks) == 2, (path, region, marks)
    text[marks[0] + 1 : marks[1]] = [indent + line for line in lines]
    path.write_text("\n".join(text) + "\n")


def check_written(path_a, path_b):
    """Check that each line stands once, in its own function."""
    _check(path_a, "process_RtE_A_D0", _DEMAND)
    _check(path_a, "process_RtE_A_E0", _EVIDENCE_A)
    _check(path_b, "process_RtE_A_E0", _EVIDENCE_B)
    assert path_a.read_text().count("\n".join(_HELPER)) == 1


def _check(path, function, lines):
    text = path.read_text()
    block = "".join(f"{_INDENT}{line}\n" for line in lines)
    assert text.count(block) == 1, f"{path}: {text.count(block)} times\n{block}"
    (node,) = (
        node
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.FunctionDef) and node.name == function
    )
    assert block.strip() in (ast.get_source_segment(text, node) or "")
