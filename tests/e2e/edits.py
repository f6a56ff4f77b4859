"""What a person writes into EDDIInput.py: D7.2 Figs 43 and 44, and a little more."""

import ast

_INDENT = " " * 8
HELPER = (
    "def is_healthy(message):",
    '    """Written by hand, beside the class."""',
    "    return message.data is True",
)
DEMAND = ("self.RtE_A_D0 = consertb.guarantees[0].active",)
EVIDENCE_A = ("self.RtE_A_E0 = is_healthy(RtE_E0)",)
EVIDENCE_B = (
    "if RtE_E0.data and not self.RtE_A_E0:",
    "    print('system B: written by hand')",
    "self.RtE_A_E0 = RtE_E0.data",
)
SEEN_AT_RUN_TIME = "system B: written by hand"


def write_region(path, region, lines, indent=_INDENT):
    """Replace what stands between the two markers of a region."""
    text = path.read_text().splitlines()
    marks = [i for i, line in enumerate(text) if f"# region: {region} " in f"{line} "]
    assert len(marks) == 2, (path, region, marks)
    text[marks[0] + 1 : marks[1]] = [indent + line for line in lines]
    path.write_text("\n".join(text) + "\n")


def edit_system_a(path):
    """Write the demand and the evidence of system A, one through a function of one's own."""
    write_region(path, "process_RtE_A_D0", DEMAND)
    write_region(path, "process_RtE_A_E0", EVIDENCE_A)
    write_region(path, "EDDIInput.module", HELPER, "")


def edit_system_b(path):
    """Write the evidence of system B, and say so when it comes."""
    write_region(path, "process_RtE_A_E0", EVIDENCE_B)


def check_edits(path_a, path_b):
    """Check that each line stands once, in its own function."""
    _check(path_a, "process_RtE_A_D0", DEMAND)
    _check(path_a, "process_RtE_A_E0", EVIDENCE_A)
    _check(path_b, "process_RtE_A_E0", EVIDENCE_B)
    assert path_a.read_text().count("\n".join(HELPER)) == 1


def _check(path, function, lines):
    text = path.read_text()
    block = "".join(f"{_INDENT}{line}\n" for line in lines)
    assert text.count(block) == 1, f"{path}: {text.count(block)} times\n{block}"
    found = [
        node
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.FunctionDef) and node.name == function
    ]
    assert len(found) == 1, (path, function)
    assert block.strip() in (ast.get_source_segment(text, found[0]) or "")
