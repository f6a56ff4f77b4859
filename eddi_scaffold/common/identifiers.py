"""Names in generated code: ids of a model are any text, identifiers are not.

The reserved words are a frozen list, not the running interpreter's, so that the same model gives
the same code under every Python version.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Container

_WORDS = """False None True and as assert async await break case class continue def del elif
else except finally for from global if import in is lambda match nonlocal not or
pass raise return self super try type while with yield _"""
RESERVED = frozenset(_WORDS.split())
TODO = "TODO"  # in a configuration, without quotes: what a person has still to decide
_MEMBERS = """begin_processing begin_step bind end_step expression look_again processed
known_for processing received setup states update update_each update_expression why"""
_INPUT_MEMBERS = frozenset(_MEMBERS.split())
"""Members of the runtime's ``EDDIInputBase``, which an attribute must not hide."""

_IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_ROS_NAME = re.compile(r"(?:[~/][A-Za-z0-9]|[A-Za-z])[A-Za-z0-9_]*(?:/[A-Za-z0-9][A-Za-z0-9_]*)*")
_PACKAGE = re.compile(r"[a-z][a-z0-9]*(_[a-z0-9]+)*")


def taken_by_python() -> dict[str, str]:
    """Return names that no package can have, because it would be a module of that name -> why."""
    modules = "it would hide a module of Python's standard library"
    return {
        **dict.fromkeys(sys.stdlib_module_names, modules),
        **dict.fromkeys(("sitecustomize", "usercustomize"), "every Python imports it at its start"),
        **dict.fromkeys(RESERVED, "it is a word of Python"),
    }


def is_identifier(name: str) -> bool:
    """Return whether ``name`` can be used in generated code unchanged (ASCII, not reserved)."""
    return (
        _IDENTIFIER.fullmatch(name) is not None
        and name not in RESERVED
        and not name.startswith("__")
    )


def key_text(key: str | int) -> str:
    """Return the key of an element for brackets: in quotes where it is not a word."""
    return str(key) if isinstance(key, int) or _IDENTIFIER.fullmatch(key) else f'"{key}"'


def attribute(name: str) -> str:
    """Return the Python name for an id: the id itself wherever possible.

    Characters outside ``[A-Za-z0-9_]`` become ``_``, a leading digit gets a ``_`` before it, and
    reserved words and members of the runtime's ``EDDIInputBase`` get one behind.
    """
    words = re.sub(r"[^A-Za-z0-9_]", "_", name)
    if not words or words[0].isdigit():
        words = f"_{words}"
    if words.startswith("__"):
        words = f"input{words}"
    hides = words in _INPUT_MEMBERS or words.startswith("process_")
    return f"{words}_" if hides or words in RESERVED else words


def is_package_name(name: str) -> bool:
    """Return whether ``name`` has the form of REP-144 and is at least two characters long."""
    return len(name) >= 2 and _PACKAGE.fullmatch(name) is not None


def is_ros_name(text: str) -> bool:
    """Return whether ``text`` is a graph resource name of ROS: of a topic, for instance.

    Its parts may begin with digits, as in ROS 1.
    """
    return _ROS_NAME.fullmatch(text) is not None


_LONGEST = 100  # letters of a package: it is also the name of files


def package_name(model_id: str) -> str:
    """Derive a package name of the form of REP-144 from a model id; may be too short or empty."""
    name = re.sub(r"[^a-z0-9]+", "_", model_id.lower()).strip("_").lstrip("0123456789_")
    return name[:_LONGEST].rstrip("_")


def free_name(base: str, taken: Container[str], mark: str = "_") -> str:
    """Return a name that is not taken: the base, else with the mark and 2, 3, ... behind it."""
    name, number = base, 1
    while name in taken:
        number += 1
        name = f"{base}{mark}{number}"
    return name


def full_topic(name: str, namespace: str, package: str) -> str:
    """Return the full name of a topic, as ROS resolves it for the node of a package.

    The name may be absolute, relative or private (``~``); the namespace of the robot is such as
    ``/robot1``, or empty.
    """
    if name.startswith("/"):
        return name
    own = f"{package}/" if name.startswith("~") else ""
    return f"{namespace}/{own}{name.removeprefix('~')}"
