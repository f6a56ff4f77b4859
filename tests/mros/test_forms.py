"""Everything that either dialect may hold, in one text each, and how each part is refused."""

from __future__ import annotations

import pytest

from eddi_scaffold.mros import MrosSyntaxError, read_ros_models, read_rossystem
from eddi_scaffold.mros.show import model_tree, system_tree

SYSTEM = """RosSystem { Name robot
  Parameters { Parameter { name speed value 3 [ 1, { a } ] type Double } },
  RosComponents {
    ComponentInterface { name base NameSpace "/b"  FromRosNode "p.base"
      RosTopicPublishers { RosTopicPublisher odom { RefPublisher "p.x.n.odom" } }
      RosSrvServers { RosServiceServer { RefServer "p.x.n.on" } }
      RosActionClients { RosClient go { RefClient "p.x.n.go" } }
      RosParameters { RosParameter { ns "k" RefParameter "p.x.n.k" } RosParameter r { value 1 } }
    }
    other
  }
  RosComponentStacks (
    ComponentStack { name arms SafetyLevel high
      QualityAttributes { a { b [ c ] ( d ) } }
      RosComponents ( ComponentInterface { name arm } ) } )
  ServiceConnections { ServiceConnection { FromSrv "base.on" ToSrv ( "arm.a", "arm.b" ) } }
}
"""
SYSTEM_TREE = """\
system robot (brace dialect)
  component base in /b from p.base
    publishes  odom = p.x.n.odom
    serves     on = p.x.n.on
    commands   go = p.x.n.go
    2 parameters
  component other
  component arm
  connection: base.on -> arm.a, arm.b"""
MODEL = """PackageSet { package {
  AmentPackage p { FromGitRepo "git@x"
    Dependencies { ExternalDependency e, PackageDependency { any [ thing ] }, q }
    spec { ServiceSpec S { request { } response { bool[] ok int8 N=3 } }
           ActionSpec A { goal MessageDefinition result { } feedback { p.T t } } }
    artifact { Artifact x { node Node { name n
      serviceserver { ServiceServer { name "on" service "p.S" namespace "g" } },
      parameter { Parameter { name k type Integer default { 3 } } } } },
      Artifact y { } }
  }, Package bare { } } }
"""
MODEL_TREE = """\
package p
  artifact x: node n
    serves     on: p.S
    1 parameter
  artifact y
  service S
    request: nothing
    response: bool[] ok, int8 N=3
  action A
    goal: nothing
    result: nothing
    feedback: p.T t
package bare"""
INDENT_SYSTEM = """robot:
  fromFile: "pkg/launch/robot.launch"
  subSystems:
    mast
  parameters:
    - speed: 3
  nodes:
    base:
      from: "p.base"
      parameters:
        - one: "x::one"
  connections:
    - [ base, arm ]
"""
INDENT_SYSTEM_TREE = """\
system robot (indent dialect)
  from pkg/launch/robot.launch
  part mast
  component base from p.base
    1 parameter
  connection: base -> arm"""
INDENT_MODEL = """p:
  fromGitRepo: "git@x"
  dependencies: [a, b]
  dependencies:
    c
    [d, e]
  artifacts:
    x:
      node: n
        actionservers:
          go:
            type: p/action/Go
            ns: /g
            qos:
              depth: 3
      parameters:
        k:
          type: Integer
  srvs:
    S
      request
      response
        bool ok
  specs:Vector3
    msg: T
      message
        poses: p/Pose[9]
        flags: [bool]
        uint8[4] raw
        int8 N= 3
"""
INDENT_MODEL_TREE = """\
package p
  artifact x: node n
    acts       go: p/action/Go
    1 parameter
  service S
    request: nothing
    response: bool ok
  topic T
    message: p/Pose[] poses, [bool] flags, uint8[] raw, int8 N=3"""


@pytest.mark.parametrize(
    ("text", "tree"), [(SYSTEM, SYSTEM_TREE), (INDENT_SYSTEM, INDENT_SYSTEM_TREE)]
)
def test_systems(text: str, tree: str) -> None:
    assert "\n".join(system_tree(read_rossystem(text))) == tree


@pytest.mark.parametrize(("text", "tree"), [(MODEL, MODEL_TREE), (INDENT_MODEL, INDENT_MODEL_TREE)])
def test_models(text: str, tree: str) -> None:
    model = read_ros_models(text)
    assert "\n".join(model_tree(model)) == tree
    assert not model.notices


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("RosComponentStacks (", "RosComponentStacks ComponentStack", "expected '(' or '{'"),
        (
            "QualityAttributes {",
            "QualityAttributes high {",
            "expected '{', found 'high'",
        ),
        ("SafetyLevel high", "Safety high", "expected 'SafetyLevel'"),
        ("[ c ]", "[ c }", "expected ']' (it closes the '[' of line 14, column 33), found '}'"),
        ("RosParameter r {", "Parameter r {", "expected 'RosParameter' or '}'"),
        ("RosClient go", "RosKlient go", "expected 'RosActionClient' or '}'"),
        ("ServiceConnection {", "Connection {", "expected 'ServiceConnection' or '}'"),
        ("value 3 [", "value 3 ) [", "closes the '{' of line 2, column 26), found ')'"),
        ("Name robot", "Name {", "expected the name of the system"),
    ],
)
def test_what_no_system_of_braces_is(old: str, new: str, said: str) -> None:
    assert old in SYSTEM
    with pytest.raises(MrosSyntaxError) as refused:
        read_rossystem(SYSTEM.replace(old, new, 1))
    assert said in refused.value.message


@pytest.mark.parametrize(
    ("end", "said"),
    [
        (" c ]", "expected ']' (it closes the '[' of line 14, column 33), found end"),
        (" [ c ]", "expected '}' (it closes the '{' of line 14, column 29), found end of file"),
        (" [ 1,", "expected '}' (it closes the '{' of line 2, column 26), found end"),
    ],
)
def test_a_system_that_ends_inside_of_something_skipped(end: str, said: str) -> None:
    with pytest.raises(MrosSyntaxError) as refused:
        read_rossystem(SYSTEM[: SYSTEM.index(end)])
    assert said in refused.value.message


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("ServiceServer {", "Server {", "expected 'ServiceServer' or '}'"),
        ("Parameter { name k", "Param { name k", "expected 'Parameter' or '}'"),
        ("bool[] ok", "bool[ ok", "expected ']'"),
        ("node Node", "node Nod", "expected"),
        ("default { 3 }", "default { '3", "never closed"),
    ],
)
def test_what_no_model_of_braces_is(old: str, new: str, said: str) -> None:
    assert old in MODEL
    with pytest.raises(MrosSyntaxError) as refused:
        read_ros_models(MODEL.replace(old, new, 1))
    assert said in refused.value.message


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("type: p/action/Go", "type:", "expected the type of 'go' behind 'type:'"),
        ("type: p/action/Go", "", "the interface 'go' has no 'type:'"),
        ("      request\n", "      question\n", "expected message, request"),
        ("uint8[4] raw", "uint8[4 raw", "this '[' is never closed"),
        ("uint8[4] raw", "uint8[4 5] raw", "expected ']'"),
        ("flags: [bool]", "flags: [bool", "this '[' is never closed"),
        ("flags: [bool]", "flags: [bool x]", "expected ']'"),
        ("int8 N= 3", "int8 N=", "expected the value of N, found end of line"),
        ('"git@x"', '"git@x" [', "this '[' is never closed"),
    ],
)
def test_what_no_model_of_lines_is(old: str, new: str, said: str) -> None:
    assert old in INDENT_MODEL
    with pytest.raises(MrosSyntaxError) as refused:
        read_ros_models(INDENT_MODEL.replace(old, new, 1))
    assert said in refused.value.message


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("    base:", "    base", "expected the name of a node followed by :, found 'base'"),
        ('"p.base"', '"p.\nbase"', "ends on its line: this quote is not closed"),
        ("      parameters:", "      interfaces:\n        - a:\n      parameters:", "behind 'a:'"),
    ],
)
def test_what_no_system_of_lines_is(old: str, new: str, said: str) -> None:
    assert old in INDENT_SYSTEM
    with pytest.raises(MrosSyntaxError) as refused:
        read_rossystem(INDENT_SYSTEM.replace(old, new, 1))
    assert said in refused.value.message
