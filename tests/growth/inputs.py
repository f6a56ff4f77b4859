"""Inputs that grow: one thing many times, for each reader."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from tests.cli.command import XML_HEAD, XML_TAIL
from tests.package_texts import INPUT, eddi_input


@dataclass(frozen=True)
class Growing:
    """A family of inputs."""

    reader: str
    file: str
    text: Callable[[int], str]


def _each(line: str, n: int) -> str:
    """Return a line for each number below n; `#` stands for the number, `%` for the next."""
    return "".join(line.replace("#", str(k)).replace("%", str(k + 1)) for k in range(n))


# EDDI XML

_DIMENSION = (
    '<dependabilityProperty><dimension xsi:type="consert_:BinaryDimension">'
    '<dimensionType name="T"/></dimension></dependabilityProperty>'
)


def _consert(inner: str, name: str = "C") -> str:
    return f'{XML_HEAD}<conSerts name="{name}">\n{inner}</conSerts>{XML_TAIL}'


def _map(key: str, values: str, model: str = "m") -> str:
    named = f'<values tag="model" value="{model}"/>' if model else ""
    return f'<keyValueMaps key="eddi.{key}">{named}{values}</keyValueMaps>\n'


def _around(hazards: str, inner: str) -> str:
    """Return a ConSert with a package of hazards behind it."""
    package = f'<odeProductPackages xsi:type="consert_:HARAPackage">{hazards}</odeProductPackages>'
    middle = "</odeProductPackages>"
    return _consert(inner).replace(middle, f"{middle}{package}", 1)


def _guarantees(n: int) -> str:
    own = "//@odeProductPackages.0/@conSerts.0/"
    edges = (
        f'<guaranteePropagation source="{own}@runtimeEvidence.#" target="{own}@guarantees.#"/>\n'
    )
    return _consert(
        _each(edges, n)
        + _each(f'<guarantees name="G#">{_DIMENSION}</guarantees>\n', n)
        + _each(f'<runtimeEvidence name="E#">{_DIMENSION}</runtimeEvidence>\n', n)
    )


def _chain_of_gates(n: int) -> str:
    own = "//@odeProductPackages.0/@conSerts.0/"
    edge = f'<guaranteePropagation source="{own}@consertGates.#" target="{own}@consertGates.%"/>\n'
    return _consert(
        f'<guaranteePropagation source="{own}@runtimeEvidence.0" target="{own}@consertGates.0"/>\n'
        + _each(edge, n - 1)
        + f'<guaranteePropagation source="{own}@consertGates.{n - 1}" target="{own}@guarantees.0"/>'
        + f'<guarantees name="G">{_DIMENSION}</guarantees>\n'
        + f'<runtimeEvidence name="E">{_DIMENSION}</runtimeEvidence>\n'
        + _each('<consertGates name="A#" gateType="AND"/>\n', n)
    )


def _reference(text: str) -> str:
    return _consert(f'<guaranteePropagation source="{text}" target="//@odeProductPackages.0"/>\n')


_XML = {
    "guarantees": _guarantees,
    "chain of gates": _chain_of_gates,
    "ConSerts": lambda n: XML_HEAD + _each('<conSerts name="C#"/>\n', n) + XML_TAIL,
    "one long reference": lambda n: _reference("//@odeProductPackages.0" + "/@conSerts.0" * n),
    "references that end nowhere": lambda n: _consert(
        _each('<guaranteePropagation source="//@nothing.#" target="//@conSert.#"/>\n', n)
    ),
    "one list of references": lambda n: _reference(" ".join(["//@odeProductPackages.0"] * n)),
    "deep elements": lambda n: XML_HEAD + "<a>" * n + "</a>" * n + XML_TAIL,
    "unknown elements": lambda n: _consert(_each("<conSertGate#/>\n", n)),
    "attributes of one element": lambda n: _consert("<guarantees " + _each('a#="x" ', n) + "/>"),
    "namespaces": lambda n: _consert("<guarantees " + _each('xmlns:a#="x#" ', n) + "/>"),
    "a long name": lambda n: _consert(
        f'<guarantees name="{"a-" * 10 * n}">{_DIMENSION}</guarantees>'
    ),
    "events in a map": lambda n: _consert(
        _map("events", _each('<values tag="EVENT" value="e# (HAZARD) := x# > 1"/>\n', n))
    ),
    "maps": lambda n: _consert(
        _each(_map("events", '<values tag="EVENT" value="e (HAZARD) := x > 1"/>', "m#"), n)
        + _each(_map("monitored_by", '<values tag="event" value="m#/e"/>', ""), n)
    ),
    "hazards": lambda n: _around(
        _each(
            '<hazards name="H#" of="//@odeProductPackages.0/@conSerts.0/@guarantees.#"/>\n',
            n,
        ),
        _each(f'<guarantees name="G#">{_DIMENSION}</guarantees>\n', n),
    ),
}

# ConSert YAML


def _yaml(guarantees: str = "", evidence: str = "", gates: str = "", edges: str = "") -> str:
    return (
        f"guarantees:\n{guarantees}evidence:\n{evidence}gates:\n{gates}tree_propagations:\n{edges}"
        "demands: []\nrequired_services: []\nprovided_services: []\n"
    )


_G = "  - {id: G#, dimensions: [{Binary: {type: T}}]}\n"
_E = "  - {id: E#, dimension: {Binary: {type: T}}}\n"
_CONSERT = {
    "guarantees": lambda n: _yaml(
        _each(_G, n), _each(_E, n), "", _each("  - {from: E#, to: G#}\n", n)
    ),
    "chain of gates": lambda n: _yaml(
        _each(_G, 1),
        _each(_E, 1),
        _each("  - {id: A#, function: And}\n", n),
        "  - {from: E0, to: A0}\n" + _each("  - {from: A#, to: A%}\n", n - 1)
        + f"  - {{from: A{n - 1}, to: G0}}\n",
    ),
    "misspelt edges": lambda n: _yaml(
        _each(_G, n), _each(_E, n), "", _each("  - {from: EE#, to: GG#}\n", n)
    ),
    "unknown keys": lambda n: _yaml(_each(_G, 1)) + _each("key#: 1\n", n),
    "the same key": lambda n: _yaml(_each(_G, 1)) + "evidence: []\n" * n,
    "ranges": lambda n: _yaml(
        "  - {id: G, dimensions: [{Numeric: {type: T, covered: ["
        + _each("{Inclusive: {start: #, end: #.5}}, ", n) + "], subset: Demand, uom: m}}]}\n"
    ),
    "deep brackets": lambda n: "[" * n,
    "aliases": lambda n: "a: &a [x]\nb: [" + "*a, " * n + "]\n",
    "doubling aliases": lambda n: "a0: &a0 [x]\n" + _each("a%: &a% [*a#, *a#]\n", n),
    "a folded text": lambda n: _yaml("  - id: G\n    description: >\n" + "      a\n\n" * n),
    "open quotes": lambda n: "'" * n,
}  # fmt: skip

# Bayesian networks


def _xdsl(nodes: str) -> str:
    return f'<?xml version="1.0"?>\n<smile version="1.0" id="N"><nodes>\n{nodes}</nodes></smile>\n'


_STATES = '<state id="a"/><state id="b"/>'
_ROOT = "<probabilities>0.5 0.5</probabilities></cpt>\n"
_XDSL = {
    "nodes": lambda n: _xdsl(_each(f'<cpt id="n#">{_STATES}{_ROOT}', n)),
    "children of one node": lambda n: _xdsl(
        f'<cpt id="r">{_STATES}{_ROOT}'
        + _each(
            f'<cpt id="n#">{_STATES}<parents>r</parents>'
            "<probabilities>0.5 0.5 0.5 0.5</probabilities></cpt>\n",
            n,
        )
    ),
    "states": lambda n: _xdsl(
        '<cpt id="n">'
        + _each('<state id="s#"/>', n)
        + f"<probabilities>{' '.join([str(1 / n)] * n)}</probabilities></cpt>\n"
    ),
    "parents of one node": lambda n: _xdsl(
        _each(f'<cpt id="n#">{_STATES}{_ROOT}', n)
        + f'<cpt id="x">{_STATES}<parents>{_each("n# ", n)}</parents>{_ROOT}'
    ),
    "misspelt parents": lambda n: _xdsl(
        _each(f'<cpt id="node#">{_STATES}{_ROOT}', n)
        + _each(f'<cpt id="x#">{_STATES}<parents>nod#</parents>{_ROOT}', n)
    ),
    "a cycle": lambda n: _xdsl(
        _each(
            f'<cpt id="n#">{_STATES}<parents>n%</parents>'
            "<probabilities>0.5 0.5 0.5 0.5</probabilities></cpt>\n",
            n,
        )
    ),
}

_BIF_ROOT = "variable n# {type discrete [2] {a, b};}\nprobability (n#) {table 0.5 0.5;}\n"
_BIF = {
    "variables": lambda n: _each(_BIF_ROOT, n),
    "rows": lambda n: (
        f"variable p {{type discrete [{n}] {{{_each('s# ', n)}}};}}\n"
        "variable c {type discrete [2] {a, b};}\nprobability (c | p) {\n"
        + _each("(s#) 0.5 0.5;\n", n)
        + "}\n"
    ),
    "misspelt states": lambda n: (
        f"variable p {{type discrete [{n}] {{{_each('state# ', n)}}};}}\n"
        "variable c {type discrete [2] {a, b};}\nprobability (c | p) {\n"
        + _each("(stat#) 0.5 0.5;\n", n)
        + "}\n"
    ),
    "open comments": lambda n: "network x { property " + "/* " * n,
    "numbers": lambda n: f"probability (c) {{table {'0.5 ' * n};}}\n",
}

# configurations

_OUTPUTS = "SimulatorOutputs:\n  - {id: o, type: std_msgs.Bool, topic: /o}\n"
_MODEL = "Model: {id: ConSertA, type: ConSert, frequency: 10}\n"
_MODEL_EVENT = "Model: {id: m, type: Events, frequency: 10}\n"


def _inputs(lines: str, outputs: str = _OUTPUTS) -> str:
    return f"{_MODEL}{outputs}EDDIInputs:\n{lines}EDDIOutputs: []\n"


_OUTPUT = "  - {id: output#, type: std_msgs.Bool, topic: /o#}\n"
_CONFIG = {
    "inputs": lambda n: _inputs(_each("  - {id: i#, requires: [o]}\n", n)),
    "misspelt requires": lambda n: _inputs(
        _each("  - {id: i#, requires: [outpt#]}\n", n), f"SimulatorOutputs:\n{_each(_OUTPUT, n)}"
    ),
    "one input that requires all": lambda n: _inputs(
        f"  - {{id: RtE_A_E0, requires: [{_each('output#, ', n)}]}}\n",
        f"SimulatorOutputs:\n{_each(_OUTPUT, n)}",
    ),
    "unknown keys": lambda n: _inputs("") + _each("Key#: 1\n", n),
    "a long field": lambda n: _inputs(
        f"  - {{id: RtE_A_E0, requires: [o], field: data{'.x' * n}}}\n"
    ),
    "expressions": lambda n: _inputs(
        _each("  - {id: i#, requires: [o], expression: 'NOT o.data'}\n", n)
    ),
    "a deep expression": lambda n: _inputs(
        f"  - {{id: RtE_A_E0, requires: [o], expression: '{'(' * n}o.data{')' * n}'}}\n"
    ),
    "comments in the block": lambda n: f"{_MODEL}SimulatorOutputs:\n" + _each(
        "  # about #\n  - {id: output#, type: std_msgs.Bool, topic: /o#}\n", n
    ),
}  # fmt: skip
_CONFIG_EVENT = {
    "inputs of events": lambda n: (
        f"{_MODEL_EVENT}SimulatorOutputs: []\nEDDIInputs:\n"
        + _each("  - {id: v#, requires: []}\n", n)
        + "EDDIOutputs:\n"
        + _each("  - {id: e#, topic: /e#}\n", n)
    )
}

# reliability

_HEAD = "horizon: 1 h\nmodels:\n"
_TREE = f"{_HEAD}  t:\n    type: fault_tree\n    top: T\n    gates:\n"
_RELIABILITY = {
    "events of a gate": lambda n: (
        f"{_TREE}      T: {{type: OR, of: [{_each('E#, ', n)}]}}\n    events:\n"
        + _each("      E#: {p: 1e-6}\n", n)
    ),
    "pairs": lambda n: (
        f"{_TREE}      T: {{type: AND, of: [{_each('G#, ', n)}]}}\n"
        + _each("      G#: {type: OR, of: [A#, B#]}\n", n)
        + "    events:\n" + _each("      A#: {p: 1e-6}\n      B#: {p: 1e-6}\n", n)
    ),
    "misspelt events": lambda n: (
        f"{_TREE}      T: {{type: OR, of: [{_each('Evnt#, ', n)}]}}\n    events:\n"
        + _each("      Event#: {p: 1e-6}\n", n)
    ),
    "models": lambda n: (
        _HEAD + _each("  m#: {type: k_out_of_n, k: 2, n: 3, rate: 1e-3 1/h}\n", n)
        + f"  s: {{type: series, of: [{_each('m#, ', n)}]}}\ntop: s\n"
    ),
    "chain of series": lambda n: (
        _HEAD + _each("  m#: {type: series, of: [m%]}\n", n)
        + f"  m{n}: {{type: k_out_of_n, k: 2, n: 3, rate: 1e-3 1/h}}\ntop: m0\n"
    ),
    "states": lambda n: (
        f"{_HEAD}  c: {{type: markov, initial: s0, fail: s{n}, arcs: ["
        + _each("{from: s#, to: s%, rate: 1e-3 1/h}, ", n) + "]}\n"
    ),
}  # fmt: skip


def _mef(text: str) -> str:
    return f'<opsa-mef>\n<define-fault-tree name="Tank">\n{text}</define-fault-tree></opsa-mef>\n'


def _mef_or(n: int) -> str:
    events = _each('<event name="e#"/>', n)
    return f'<define-gate name="G"><or>{events}</or></define-gate>\n'


_MEF_EVENT = '<define-basic-event name="{}"><float value="1e-6"/></define-basic-event>\n'
_MEF = {
    "events": lambda n: _mef(
        _mef_or(n)
        + _each(_MEF_EVENT.format("e#"), n)
    ),
    "gates": lambda n: _mef(
        _each('<define-gate name="g#"><or><event name="g%"/><event name="a"/></or>'
              "</define-gate>\n", n)
        + _MEF_EVENT.format(f"g{n}") + _MEF_EVENT.format("a")
    ),
    "misspelt events": lambda n: _mef(
        _each('<define-gate name="gate#"><event name="evnt#"/></define-gate>\n', n)
        + _each(_MEF_EVENT.format("event#"), n)
    ),
    "parameters": lambda n: _mef(
        _each('<define-parameter name="p#"><parameter name="p%"/></define-parameter>\n', n)
    ),
    "uses of a parameter": lambda n: _mef(
        '<define-parameter name="p"><add>' + '<float value="0.001"/>' * n
        + "</add></define-parameter>\n"
        + _each('<define-basic-event name="e#"><parameter name="p"/></define-basic-event>\n', n)
        + _mef_or(n)
    ),
    "deep formulas": lambda n: _mef(
        f'<define-gate name="G">{"<not>" * n}<event name="a"/>{"</not>" * n}</define-gate>\n'
        + _MEF_EVENT.format("a")
    ),
}  # fmt: skip

# events

_EVENTS = {
    "events": lambda n: "VAR x : NUMBER TIMEOUT 1s\n" + _each("EVENT e# := x > #\n", n),
    "events of events": lambda n: (
        "VAR x : NUMBER TIMEOUT 1s\nEVENT e0 := x > 1\n" + _each("EVENT e% := NOT e#\n", n)
    ),
    "variables": lambda n: (
        _each("VAR v# : BOOL TIMEOUT 1s\n", n) + "EVENT e := v0" + _each(" AND v#", n) + "\n"
    ),
    "misspelt variables": lambda n: (
        _each("VAR value# : BOOL TIMEOUT 1s\n", n) + _each("EVENT e# := valu#\n", n)
    ),
    "misspelt functions": lambda n: "VAR x : NUMBER\nEVENT e := TRUE" + " AND AVERGE(x) > 1" * n,
    "wrong characters": lambda n: "EVENT e := TRUE" + "?" * n,
    "a long sum": lambda n: "VAR x : NUMBER TIMEOUT 1s\nEVENT e := x" + " + x" * n + " > 1\n",
    "deep parentheses": lambda n: f"EVENT e := {'(' * n}TRUE{')' * n}\n",
    "many NOT": lambda n: f"EVENT e := {'NOT ' * n}TRUE\n",
    "a long number": lambda n: f"EVENT e := {'9' * n} > 0\n",
    "literals": lambda n: f"ENUM E ({_each('L#, ', n)}X)\nVAR v : E TIMEOUT 1s\nEVENT e := v = X\n",
    "events of one name": lambda n: "EVENT e := TRUE\n" * n,
    "windows": lambda n: (
        "VAR x : BOOL TIMEOUT 1s\nEVENT e := x" + _each(" AND ONCE(x, %s)", n) + "\n"
    ),
}

# models of robots

_NODE = '    n#:\n      from: "p.a"\n      interfaces:\n        - i: pub-> "a::t"\n'
_ROBOTS = {
    "nodes": ("rossystem", lambda n: "s:\n  nodes:\n" + _each(_NODE, n)),
    "publishers": (
        "ros1",
        lambda n: "p:\n  artifacts:\n    a:\n      node: a\n      publishers:\n"
        + _each("        t#:\n          type: std_msgs/msg/Bool\n", n),
    ),
    "braces": (
        "rossystem",
        lambda n: "RosSystem { Name s RosComponents (\n"
        + _each('ComponentInterface { name n# FromRosNode "p.a.n" },\n', n) + "))",
    ),
    "open comments": ("rossystem", lambda n: "RosSystem {" + "/* " * n),
    "open quotes": ("ros", lambda n: "PackageSet { 'a " + "' " * n),
    "deep blocks": ("ros", lambda n: "".join(" " * k + "a:\n" for k in range(n))),
    "one long line": ("ros", lambda n: "a: " + "[" * n),
}  # fmt: skip

# recordings

_ROW = "RtE_A_D0,RtE_A_E0,t\n"
_RECORDINGS = {
    "rows": lambda n: _ROW + _each("true,false,#\n", n),
    "bad rows": lambda n: _ROW + _each("treu,1,2,3\n", n),
    "columns": lambda n: _each("RtE_A_E#,", n) + "t\n" + "1," * n + "0\n",
    "quoted cells": lambda n: _ROW + '"tr""ue"' * n + "\n",
    "open quoted cells": lambda n: _ROW + '" ' * n + "\n",
    "a long number": lambda n: _ROW + f"true,true,{'9' * n}\n",
}

# hand edits


def _package(n: int) -> str:
    return eddi_input([f"E{k}" for k in range(n)])


_HAND = "    '''-----Manual edit {}-----'''  # region: process_E#\n"
_SYNC = {
    "regions": _package,
    "regions that were edited": lambda n: _package(n).replace("message.data", "not message.data"),
    "regions without an id": lambda n: "class A:\n" + _each(
        "    def process_E#(self):\n        '''-----Manual edit begin-----'''\n        x = 1\n"
        "        '''-----Manual edit end-----'''\n",
        n,
    ),
    "regions of one function": lambda n: "def f(self):\n" + _each(
        _HAND.format("begin") + "    self.a# = 1\n    b# = 2\n" + _HAND.format("end"), n
    ),
    "begin markers": lambda n: _each(_HAND.format("begin"), n),
    "the same region": lambda n: "class A:\n" + (
        _HAND.format("begin") + "    x = 1\n" + _HAND.format("end")
    ) * n,
    "statements": lambda n: _package(2) + _each("x# = 1\n", n),
    "a long line": lambda n: _package(2) + f"x = '{'a' * n}'\n",
    "a body of many lines": lambda n: _package(2).replace(
        "        self.E0 = message.data\n", _each("        x# = message.data\n", n)
    ),
    "dashes": lambda n: _package(2) + "-" * n + "\n",
    "former ids": lambda n: _package(2) + (
        f"'''-----Manual edit begin-----''' # region: a was: {'a, ' * n}\n"
    ),
}  # fmt: skip

# deployments

_ROBOT = "  - {name: arm#, monitors: [{config: arm_config.yml}]}\n"
_CART = "  - {name: cart, monitors: [{config: cart_config.yml}]}\n"
_DEPLOYMENT = {
    "robots that fulfil a demand": lambda n: (
        f"Robots:\n{_CART}{_each(_ROBOT, n)}Bindings: [{{demand: ArmIsParked}}]\n"
    ),
    "overrides": lambda n: (
        "Robots:\n  - name: arm\n    monitors:\n      - config: arm_config.yml\n"
        "        override:\n          SimulatorOutputs:\n"
        + _each("            - {id: s#, type: std_msgs/Bool, topic: t#}\n", n)
    ),
}

# packages of the old tools

_CLASS = "class EDDIInput:\n    def __init__(self):\n        pass\n"
_ADOPT = {
    "methods": lambda n: _CLASS + _each(
        "    def process_E#(self, m):\n        '''-----Manual edit begin-----'''\n"
        "        self.E# = m.data\n        '''-----Manual edit end-----'''\n",
        n,
    ),
    "imports": lambda n: _each("import a#\n", n) + _CLASS,
    "statements of one line": lambda n: "a = 1;" * n + "\n" + _CLASS,
    "helpers": lambda n: _CLASS + _each("    def helper#(self):\n        return 1\n", n),
    "plus": lambda n: f"{_CLASS}x = 1{' + 1' * n}\n",
    "branches": lambda n: f"{_CLASS}if a:\n    pass\n" + "elif a:\n    pass\n" * n,
    "a long number": lambda n: f"{_CLASS}x = 0x{'f' * n}\n",
}  # fmt: skip

_FAMILIES: list[tuple[str, str, dict[str, Callable[[int], str]]]] = [
    ("EDDI XML", "m.xml", _XML),
    ("ConSert YAML", "c.yml", _CONSERT),
    ("XDSL", "n.xdsl", _XDSL),
    ("BIF", "n.bif", _BIF),
    ("configuration", "two-conserts/damaged_consert_a_config.yml", _CONFIG),
    ("configuration", "motor-watch/damaged_motor_config.yml", _CONFIG_EVENT),
    ("deployment", "deployment.yml", _DEPLOYMENT),
    ("reliability YAML", "r.yml", _RELIABILITY),
    ("Open-PSA", "t.xml", _MEF),
    ("events", "m.events", _EVENTS),
    ("recordings", "r.csv", _RECORDINGS),
    ("sync", INPUT, _SYNC),
    ("adopt", "ros/scripts/EDDIInput.py", _ADOPT),
]
GROWING = {
    f"{reader}: {name}": Growing(reader, file, text)
    for reader, file, texts in _FAMILIES
    for name, text in texts.items()
} | {
    f"robot models: {name}": Growing("robot models", f"r.{suffix}", text)
    for name, (suffix, text) in _ROBOTS.items()
}
