"""Manifests and launch files are merged by element, CMake files by command."""

from __future__ import annotations

import contextlib
import re
import time
from xml.etree import ElementTree as ET

import pytest
from hypothesis import given
from hypothesis import strategies as st

from eddi_scaffold.regions import cmake_tree, xml_tree
from eddi_scaffold.regions.marked_file import split_lines
from eddi_scaffold.regions.merge import merge
from eddi_scaffold.regions.result import Merged

MANIFEST = """\
<?xml version="1.0"?>
<package format="3">
  <name>rover</name>
  <version>0.1.0</version>
  <description>Monitor of a rover</description>
  <maintainer email="a@b.c">A</maintainer>
  <license>MIT</license>

  <buildtool_depend>catkin</buildtool_depend>
  <exec_depend>std_msgs</exec_depend>
  <exec_depend>rospy</exec_depend>

  <test_depend>rostest</test_depend>
</package>
"""
LAUNCH = """\
<!-- One namespace
     for each robot. -->
<launch>
  <arg name="frequency" default="10" doc="Hz"/>
  <arg name="respawn" default="true"
       doc="start it again"/>
  <node pkg="rover" type="RosNode.py" name="rover" output="screen"
        respawn="$(arg respawn)">
    <param name="frequency" value="$(arg frequency)" type="double"/>
    <param name="verbose" value="false"/>
  </node>
</launch>
"""
CMAKE = """\
cmake_minimum_required(VERSION 3.10.0)
project(rover)

find_package(catkin REQUIRED)
catkin_package()

install(
  DIRECTORY config launch
  DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION}
)

if(CATKIN_ENABLE_TESTING)
  find_package(rostest QUIET)
  if(rostest_FOUND)
    add_rostest(test/monitor.test)
  endif()
endif()
"""
TEXTS = {"package.xml": MANIFEST, "launch/rover.launch": LAUNCH, "CMakeLists.txt": CMAKE}
SPLIT = {
    "package.xml": xml_tree.split,
    "launch/rover.launch": xml_tree.split,
    "CMakeLists.txt": cmake_tree.split,
}


def changed(text: str, *changes: tuple[str, str]) -> str:
    for old, new in changes:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return text


def filled(text: str) -> list[str]:
    return [line for line in text.split("\n") if line.strip()]


def merged(path: str, base: str, mine: str, theirs: str) -> Merged:
    result = merge(path, base, mine, theirs)
    assert isinstance(result, Merged)
    assert result.text is not None
    if path != "CMakeLists.txt":
        ET.fromstring(result.text)
    again = merge(path, theirs, result.text, theirs)
    assert isinstance(again, Merged)
    assert (again.text, again.patch) == (result.text, "")
    return result


@pytest.mark.parametrize(
    ("path", "mine", "theirs"),
    [  # each person's line is right beside what the template changes
        (
            "package.xml",
            [("  <exec_depend>rospy</exec_depend>\n", "  <exec_depend>tf</exec_depend>\n" * 1
              + "  <exec_depend>rospy</exec_depend>\n")],
            [("std_msgs", "sensor_msgs"), ("<version>0.1.0", "<version>0.2.0")],
        ),
        (
            "package.xml",
            [("<license>MIT", "<license>BSD"), ("catkin</b", "catkin</b")],
            [('email="a@b.c">A<', 'email="x@b.c">X<')],
        ),
        (
            "package.xml",
            [("\n  <test_depend>", "\n  <!-- mine -->\n  <depend>tf</depend>\n  <test_depend>")],
            [("rospy</exec_depend>\n", "rospy</exec_depend>\n  <doc_depend>x</doc_depend>\n")],
        ),
        (
            "launch/rover.launch",
            [("  </node>", '    <remap from="scan" to="laser"/>\n  </node>')],
            [('<param name="verbose" value="false"/>', '<param name="verbose" value="true"/>')],
        ),
        (
            "launch/rover.launch",
            [('default="10" doc', 'default="25" doc')],
            [('default="true"\n', 'default="false"\n'), ("for each robot", "of each robot")],
        ),
        (
            "launch/rover.launch",
            [("<launch>\n", '<launch>\n  <include file="mine.launch"/>\n')],
            [('  <arg name="frequency"', '  <arg name="ns"/>\n  <arg name="frequency"')],
        ),
        (
            "CMakeLists.txt",
            [("find_package(catkin REQUIRED)", "find_package(catkin REQUIRED COMPONENTS tf)")],
            [("catkin_package()", "catkin_python_setup()\ncatkin_package()"), ("3.10.0", "3.16")],
        ),
        (
            "CMakeLists.txt",
            [("  if(rostest_FOUND)", "  # mine\n  add_test(own)\n  if(rostest_FOUND)")],
            [("rostest QUIET", "rostest REQUIRED"), ("monitor.test", "all.test")],
        ),
        (
            "CMakeLists.txt",
            [("DIRECTORY config launch", "DIRECTORY config launch maps")],
            [("catkin_package()\n\n", "catkin_package()\n\nset(X [[)]])  # )\n")],
        ),
    ],
)  # fmt: skip
def test_edits_beside_a_change_stay_where_they_are(
    path: str, mine: list[tuple[str, str]], theirs: list[tuple[str, str]]
) -> None:
    base = TEXTS[path]
    result = merged(path, base, changed(base, *mine), changed(base, *theirs))
    assert result.patch == ""
    text = result.text or ""
    for _, new in (*mine, *theirs):
        for line in new.strip().split("\n"):
            assert line in text, line
    grown = sum(len(filled(new)) - len(filled(old)) for old, new in (*mine, *theirs))
    assert len(filled(text)) == len(filled(base)) + grown


@pytest.mark.parametrize(
    ("path", "change", "mine", "theirs"),
    [
        ("package.xml", "0.1.0", "7.0.0", "0.2.0"),
        ("launch/rover.launch", 'default="10"', 'default="20"', 'default="30"'),
        ("CMakeLists.txt", "REQUIRED", "REQUIRED mine", "QUIET"),
    ],
)
def test_only_what_conflicts_is_rejected(path: str, change: str, mine: str, theirs: str) -> None:
    base, kept = TEXTS[path], "# kept\n" if path == "CMakeLists.txt" else "<!-- kept -->\n"
    own = base.replace(change, mine) + kept
    result = merged(path, base, own, base.replace(change, theirs))
    assert theirs in (result.text or "")
    assert kept in (result.text or "")
    assert mine in result.patch
    assert "kept" not in result.patch
    assert result.notes[0].attention


def test_a_node_that_is_renamed_keeps_what_is_in_it() -> None:
    path, remap = "launch/rover.launch", '    <remap from="a" to="b"/>\n'
    mine = changed(LAUNCH, ("  </node>", f"{remap}  </node>"))
    theirs = changed(LAUNCH, ('pkg="rover"', 'pkg="truck"'), ('name="rover"', 'name="truck"'))
    result = merged(path, LAUNCH, mine, theirs)
    assert remap in (result.text or "")
    assert result.patch == ""


@pytest.mark.parametrize(
    "text",
    [
        "<!DOCTYPE a [<!ENTITY b 'c'>]>\n<a>&b;</a>\n",
        "<a>\n<b></a>\n",
        "no markup\n",
    ],
)
def test_texts_that_are_no_plain_elements(text: str) -> None:
    with pytest.raises(SyntaxError):
        xml_tree.split(split_lines(text))


@pytest.mark.parametrize("text", ["if(A)\n", "set(A [[)\n", 'set("\n', "word\n", "endif()\n("])
def test_texts_that_are_no_commands(text: str) -> None:
    with pytest.raises(SyntaxError):
        cmake_tree.split(split_lines(text))


# generated texts ----------------------------------------------------------------------------------
_WORDS = st.sampled_from(["rospy", "tf", "nav", "std_msgs", "maps"])
_XML = st.recursive(
    st.one_of(
        _WORDS.map(lambda word: [f"<exec_depend>{word}</exec_depend>"]),
        _WORDS.map(lambda word: [f'<arg name="{word}"', '  default="1"/>']),
        _WORDS.map(lambda word: [f"<!-- {word} <a>", "  -->"]),
        st.just([""]),
        _WORDS.map(lambda word: [f"<a/><b>{word}</b> <!-- c", "-->"]),
    ),
    lambda inner: st.lists(inner, max_size=4).map(
        lambda parts: ["<group>", *(f"  {line}" for part in parts for line in part), "</group>"]
    ),
    max_leaves=8,
)
_CMAKE = st.recursive(
    st.one_of(
        _WORDS.map(lambda word: [f"find_package({word})  # )"]),
        _WORDS.map(lambda word: ["install(", f"  DIRECTORY {word}", ")"]),
        _WORDS.map(lambda word: [f"#[[ {word}(", "]]"]),
        st.just([""]),
        _WORDS.map(lambda word: [f'set({word} "a(', '\\"b" [=[ ]] ]=]) message(x)']),
    ),
    lambda inner: st.lists(inner, max_size=4).map(
        lambda parts: ["if(A)", *(f"  {line}" for part in parts for line in part), "endif()"]
    ),
    max_leaves=8,
)


def document(path: str, parts: list[list[str]]) -> str:
    lines = [line for part in parts for line in part]
    lines = lines if path == "CMakeLists.txt" else ["<launch>", *lines, "</launch>"]
    return "".join(f"{line}\n" for line in lines)


@st.composite
def three_texts(draw: st.DrawFn) -> tuple[str, str, str, str]:
    path = draw(st.sampled_from(["package.xml", "CMakeLists.txt"]))
    part = _CMAKE if path == "CMakeLists.txt" else _XML
    base = draw(st.lists(part, max_size=6))
    texts = []
    for mark in ("theirs", "mine"):
        new = [list(one) for one in base]
        for _ in range(draw(st.integers(0, 3))):
            at = draw(st.integers(0, len(new)))
            what = draw(st.sampled_from(["add", "remove", "mark"]))
            if what == "add":
                new.insert(at, draw(part))
            elif new and what == "remove":
                del new[at % len(new)]
            elif new:
                one = new[at % len(new)]
                number = draw(st.integers(0, len(one) - 1))
                one[number] = re.sub(r"rospy|tf|nav|std_msgs|maps", f"{mark}{at}", one[number])
        texts.append(document(path, new))
    return path, document(path, base), texts[1], texts[0]


@given(texts=three_texts())
def test_a_tree_is_the_text(texts: tuple[str, str, str, str]) -> None:
    path, *all_three = texts
    for text in all_three:
        lines = split_lines(text)
        items = SPLIT[path](lines)
        assert [line for item in items for line in item.lines] == lines


@given(texts=three_texts())
def test_no_line_of_a_person_is_lost(texts: tuple[str, str, str, str]) -> None:
    path, base, mine, theirs = texts
    result = merge(path, base, mine, theirs)
    assert isinstance(result, Merged)
    text = result.text or ""
    kept = {line.strip() for line in (text + result.patch.replace("\n+", "\n")).split("\n")}
    assert {line.strip() for line in mine.split("\n")} - {
        line.strip() for line in base.split("\n")
    } <= kept
    (cmake_tree if path == "CMakeLists.txt" else xml_tree).split(split_lines(text))
    if mine == base:
        assert filled(text) == filled(theirs)
    if theirs == base:
        assert (filled(text), result.patch) == (filled(mine), "")


@pytest.mark.parametrize(
    "text",
    [
        "<a>" + "<b>" * 20_000 + "</b>" * 20_000 + "</a>\n",
        "<a>" + "<!-- -->" * 50_000 + "</a>\n",
        "<a>\n" + "<b/>\n" * 50_000 + "</a>\n",
        "(" * 100_000,
        "set([[" * 30_000,
        "if(A)\n" * 30_000,
        "a" * 300_000,
        "set(x)\n" * 30_000 + "set(" + "[" * 100_000 + ")",
    ],
)
def test_hostile_texts_are_split_in_time(text: str) -> None:
    start = time.process_time()
    for split in (xml_tree.split, cmake_tree.split):
        with contextlib.suppress(SyntaxError):
            split(split_lines(text))
    assert time.process_time() - start < 5
