"""The readers on real files, on damaged ones, and on the corners of both dialects."""

from __future__ import annotations

import json
from typing import Any

import pytest

from eddi_scaffold.mros import MrosSyntaxError, read_ros_models, read_rossystem
from eddi_scaffold.mros.resolving import noticed
from eddi_scaffold.mros.show import failure_json, model_json, system_json
from tests.data_files import data_file
from tests.mros.words import as_word


def found(data: bytes | str, name: str) -> dict[str, Any]:
    try:
        if name.endswith("rossystem"):
            return system_json(read_rossystem(data, name))
        return model_json(read_ros_models(data, name))
    except MrosSyntaxError as failed:
        return failure_json(failed)


def test_every_file_of_the_corpus() -> None:
    corpus = data_file("mros/corpus")
    lines = data_file("mros/golden.jsonl").read_text("utf-8").splitlines()
    different = []
    for line in lines:
        wanted = json.loads(line)
        name = wanted.pop("file")
        got = found((corpus / name).read_bytes(), name)
        wanted.pop("msg", None)
        got.pop("msg", None)
        for row in got.get("warnings", []):
            row[2] = as_word(row[2])
        if got != wanted:
            different.append(name)
    assert (different, len(lines)) == ([], 552)


def test_the_errors_of_damaged_texts() -> None:
    different: list[str] = []
    for line in data_file("mros/errors.jsonl").read_text("utf-8").splitlines():
        case = json.loads(line)
        read = read_rossystem if case["file"] == "rossystem" else read_ros_models
        try:
            problem = next(noticed(read(case["text"], "damaged")))
            place, message = (problem.place.line, problem.place.col), problem.message
        except MrosSyntaxError as failed:
            place, message = (failed.line, failed.col), failed.message
            lines = [*case["text"].split("\n"), ""]
            if failed.source_line != lines[failed.line - 1]:
                different.append(case["name"])
        assert place == (case["line"], case["col"]), case["name"]
        for word in case["mention"]:
            assert word in message, case["name"]
    assert not different


BRACE = """RosSystem { Name demo
  RosComponents (
    ComponentInterface { name a NameSpace "/a/"
      RosPublishers { RosPublisher 'value' { ns "x" RefPublisher "p.x.n.scan/one.two" }, } }
    // a comment
    ComponentInterface { name b /* another */
      RosSubscribers { RosSubscriber { RefSubscriber 'q.y.m./scan' } }
      RosParameters { RosParameter 'k' { RefParameter 'q.y.m.k' value [ "a
b", { c : 1 } ] } } }
  )
  TopicConnections { TopicConnection message { From ( 'a.value' ) To ( 'b./scan' ) } }
}
"""


def test_brace_system() -> None:
    system = read_rossystem(BRACE)
    a, b = system.components
    (value,) = a.interfaces
    assert (value.kind, value.name, value.ref, value.ns) == (
        "publisher",
        "value",
        "p.x.n.scan/one.two",
        "x",
    )
    assert (value.line, value.col) == (4, 23)
    assert b.interfaces[0].name == "/scan"  # without a name: the last part of the reference
    assert b.parameters == 1
    (connection,) = system.connections
    assert (connection.kind, connection.name) == ("topic", "message")
    assert (connection.sources, connection.targets) == (("a.value",), ("b./scan",))


def test_byte_order_mark_and_windows_line_ends_change_nothing() -> None:
    data = b"\xef\xbb\xbf" + BRACE.replace("\n", "\r\n").encode()
    assert system_json(read_rossystem(data)) == system_json(read_rossystem(BRACE))


INDENT = """demo: # comment
\tnodes:
\t  a:
\t    from: "p.n"
\t    namespace: ns
\t    interfaces:
\t      - out: pub-> "x::scan"
   # a comment at any column
\t      -in:sub->"y::scan"
\t      - "s": ss-> 'y::on'
\t    parameters:
\t      - "urdf": "x::urdf"
\t        value: "<robot>
  <link/>
</robot>"
\t  a:
\t    from: "q.m"
\tconnections:
\t  - [ out,
     in ]
\t  -[a, b]
"""


def test_indentation_system() -> None:
    system = read_rossystem(INDENT)
    first, second = system.components  # two nodes of one name are legal
    assert (first.from_node, first.namespace, second.from_node) == ("p.n", "ns", "q.m")
    assert [(one.kind, one.name, one.ref) for one in first.interfaces] == [
        ("publisher", "out", "x::scan"),
        ("subscriber", "in", "y::scan"),
        ("serviceserver", "s", "y::on"),
    ]
    assert (first.interfaces[1].line, first.interfaces[1].col) == (9, 9)
    assert [one.sources + one.targets for one in system.connections] == [("out", "in"), ("a", "b")]


def test_a_tab_counts_eight_columns() -> None:
    text = "demo:\n\tnodes:\n\t\ta:\n                  from: 'p.n'\n"
    assert read_rossystem(text).components[0].from_node == "p.n"
    with pytest.raises(MrosSyntaxError, match="indentation of 12"):
        read_rossystem("demo:\n\tnodes:\n\t\ta:\n\t\t\tfrom: 'p.n'\n            b:\n")


def test_old_form_of_references() -> None:
    text = (
        'demo:\n  nodes:\n    a:\n      interfaces:\n        scan:\n          fromPub: "p.x.n.s"\n'
    )
    (interface,) = read_rossystem(text).components[0].interfaces
    assert (interface.kind, interface.name, interface.ref) == ("publisher", "scan", "p.x.n.s")


def test_unknown_keys_are_warnings_and_misspelt_ones_errors() -> None:
    text = "demo:\n  colour: red\n  node:\n    a:\n      from: 'p.n'\n"
    system = read_rossystem(text)
    assert system.components == ()
    assert [(one.case[:4], one.line) for one in system.notices] == [
        ("M005", 2),
        ("M006", 3),
    ]
    assert system.notices[1].fields["meant"] == "nodes"


MODEL = """PackageSet { CatkinPackage p {
  Specs { TopicSpec T { message {
    uint8 A=1 uint8 B='x' geometry_msgs.Pose[3] poses float32[] v } } }
  Artifact x { Node { name n
    Publishers { Publisher { name message message "p.T" namespace GlobalNamespace { "g" } } }
    ActionServers { ActionServer { name action action "p.Go" } } } } } } }
"""


def test_brace_model() -> None:
    model = read_ros_models(MODEL)
    (package,) = model.packages
    (spec,) = package.specs
    ((part, fields),) = spec.sections
    assert (package.name, spec.kind, part) == ("p", "topic", "message")
    assert [(one.type, one.name, one.value) for one in fields] == [
        ("uint8", "A", "1"),
        ("uint8", "B", "x"),
        ("geometry_msgs.Pose[]", "poses", None),
        ("float32[]", "v", None),
    ]
    (artifact,) = package.artifacts
    assert [(one.kind, one.name, one.type) for one in artifact.interfaces] == [
        ("publisher", "message", "p.T"),
        ("actionserver", "action", "p.Go"),
    ]
    assert [(one.case, one.line, one.col) for one in model.notices] == [("M004.brace", 6, 74)]


@pytest.mark.parametrize(
    ("text", "case", "why"),
    [
        ('<?xml version="1.0"?><x/>', "M001.foreign", "xmi"),
        ("---\nmy:\n  systems:\n    a:\n", "M001.foreign", "rossdl"),
        ("  // nothing\n/* at all */ # here\n", "M001.empty", ""),
    ],
)
def test_what_is_something_else_is_said_by_name(text: str, case: str, why: str) -> None:
    with pytest.raises(MrosSyntaxError) as refused:
        read_rossystem(text)
    assert (refused.value.case, refused.value.format) == (case, why)


def test_bytes_that_are_no_text() -> None:
    with pytest.raises(MrosSyntaxError, match="byte 4 ") as refused:
        read_rossystem(b"a:\n \xff")
    assert (refused.value.line, refused.value.col) == (2, 2)
