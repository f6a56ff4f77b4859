"""Templates put answers in place and loop; they hold no logic and see nothing but the answers."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache
from itertools import pairwise
from pathlib import Path

import pytest
import yaml
from jinja2 import Environment, meta, nodes

from tests.checkouts import HERE

TEMPLATES = HERE / "copier_templates"
ABOUT = sorted(TEMPLATES.glob("*/about.jinja"))
"""What each template says of itself."""
NO_OUTPUT = {TEMPLATES / "shapes.jinja", TEMPLATES / "parts.jinja", *ABOUT}
NO_OUTPUT |= {TEMPLATES / "answers.jinja"}  # the one layout that Python cannot make for Copier
"""Values for the questions, and macros: these render nothing by themselves."""
FILES = sorted(
    path for path in TEMPLATES.rglob("*.jinja") if path.is_file() and path not in NO_OUTPUT
)
SHARED = sorted(TEMPLATES.glob("questions/*.yml"))
OWN = sorted(TEMPLATES.glob("*/questions.yml"))
NAMES = sorted({part for path in TEMPLATES.rglob("*") for part in path.parts if "{" in part})
TAGS = {"for", "endfor", "if", "else", "endif", "include", "raw", "endraw"}
FILTERS = {
    "default",  # for what only some items have
    "e",
    "indent",
    "join",
    "replace",  # of the imports in compiled.py, where the runtime is a part of the package
    "tojson",  # a TOML list of strings is one of JSON
}
LOOPS = {"item": "messages", "module": "modules", "alias": "aliases", "node": "nodes"}
"""Name -> the list of which a file name takes one after the other."""
LOGIC = (
    nodes.Assign, nodes.AssignBlock, nodes.BinExpr, nodes.Call, nodes.CallBlock, nodes.Concat,
    nodes.CondExpr, nodes.Dict, nodes.FilterBlock, nodes.List, nodes.Macro, nodes.Test,
)  # fmt: skip
PER_FILE = {
    "alias_module.py.jinja": "alias",
    "editable_module.py.jinja": "module",
    "mros_monitor.jinja": "node",
}
"""Included by files that a loop names, which give it that variable."""
ANSWERS_FILE = "{{_copier_conf.answers_file}}.jinja"
ids = pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(TEMPLATES)))


def asked_in(path: Path) -> dict[str, dict[str, object]]:
    data = yaml.safe_load(path.read_text("utf-8"))
    return {name: question for name, question in data.items() if not name.startswith("_")}


@cache
def questions() -> frozenset[str]:
    names = (name for path in (*SHARED, *OWN) for name in asked_in(path))
    return frozenset(names) | {"_copier_conf", "_copier_answers"}


@cache
def environment() -> Environment:
    settings = (HERE / "copier.yml").read_text("utf-8").partition("\n---\n")[0]
    env = Environment(**yaml.safe_load(settings)["_envops"])
    env.filters["to_nice_yaml"] = str
    return env


def tags_of(text: str) -> Iterator[str]:
    tokens = [token for token in environment().lex(text) if token[1] != "whitespace"]
    for (_, kind, _), (_, _, value) in pairwise(tokens):
        if kind == "block_begin":
            yield value


@ids
def test_a_template_sees_answers_and_holds_no_logic(path: Path) -> None:
    text, is_answers = path.read_text("utf-8"), path.name == ANSWERS_FILE
    parsed = environment().parse(text)
    assert set(tags_of(text)) <= TAGS | ({"import"} if is_answers else set())
    allowed = FILTERS | ({"to_nice_yaml"} if is_answers else set())
    assert {node.name for node in parsed.find_all(nodes.Filter)} <= allowed
    logic = [type(node).__name__ for node in parsed.find_all(LOGIC) if not is_answers]
    assert not logic, "derive it in Python: an answer is text that is ready to be put in place"
    for node in parsed.find_all(nodes.If):  # a condition is a flag, or the end of a loop
        test = node.test.node if isinstance(node.test, nodes.Not) else node.test
        is_end = test == nodes.Getattr(nodes.Name("loop", "load"), "last", "load")
        assert is_end or isinstance(test, nodes.Name)
    of_the_name = {name for name in LOOPS if f"yield {name} from" in path.name}
    of_the_name |= {PER_FILE[path.name]} if path.name in PER_FILE else set()
    seen = meta.find_undeclared_variables(parsed)
    assert seen <= questions() | of_the_name
    assert is_answers or "_copier_answers" not in seen
    for name in meta.find_referenced_templates(parsed):
        assert name is not None, "a constant"
        assert (HERE / name).is_file(), name
    # Quoting for every language but XML is done in Python, where it is tested.
    assert "| e " not in text or path.name == "package.xml.jinja"


def test_what_a_file_shows_is_checked() -> None:
    asked = [item for path in (*SHARED, *OWN) for item in asked_in(path).items()]
    free = {name for name, question in asked if not {"validator", "choices"} & {*question}}
    only_ours = {"config", "default_guarantees", "files", "interfaces"}
    assert free == only_ours
    seen = [
        meta.find_undeclared_variables(environment().parse(p.read_text("utf-8"))) for p in FILES
    ]
    assert not only_ours & set().union(*seen)


def test_copier_reads_every_file_of_questions() -> None:
    settings = (HERE / "copier.yml").read_text("utf-8")
    patterns = re.findall(r"^!include (\S+)$", settings, re.MULTILINE)
    found = [path for pattern in patterns for path in HERE.glob(pattern)]
    assert sorted(found) == sorted([*SHARED, *OWN])


def test_a_question_stands_in_one_file() -> None:
    """Copier would take the last one of a name, in the order of the disk."""
    names = [name for path in (*SHARED, *OWN) for name in asked_in(path)]
    assert len(names) == len(set(names))


def test_only_its_own_files_name_a_template() -> None:
    """A new platform adds files, and changes none."""
    names = {path.parent.name for path in ABOUT} - {"start"}
    for path in [*SHARED, HERE / "copier.yml", *TEMPLATES.glob("*.jinja")]:
        assert not [name for name in names if name in path.read_text("utf-8")], path
    for path in OWN:
        others = names - {path.parent.name}
        text = path.read_text("utf-8")
        assert not [name for name in others if name in text], path
        settings = yaml.safe_load(text)
        conditions = [question["when"] for question in asked_in(path).values()]
        conditions += settings.get("_skip_if_exists", []) + settings.get("_exclude", [])
        here = f"template == '{path.parent.name}'"
        assert all(here in str(condition) for condition in conditions), path


def test_a_template_asks_groups_that_there_are() -> None:
    groups = {
        group
        for path in SHARED
        for question in asked_in(path).values()
        for group in re.findall(r"'(\w+)' in about.asks", str(question.get("when")))
    }
    asked = {path: environment().from_string(path.read_text("utf-8")).module for path in ABOUT}
    assert groups == {group for about in asked.values() for group in about.asks}


def test_names_of_files() -> None:
    loops = {f"yield {name} from {list_}" for name, list_ in LOOPS.items()}
    variables = {"_copier_conf.answers_file", "package", "stage", *(f"{n}.name" for n in LOOPS)}
    for name in NAMES:
        parts = re.findall(r"{{(.*?)}}|{%(.*?)%}", name)
        assert {part[0].strip() for part in parts if part[0]} <= variables, name
        assert {part[1].strip() for part in parts if part[1]} <= {*loops, "endyield"}, name


def test_copier_writes_over_nothing_of_a_person() -> None:
    """Its own places are the answers and `.eddi/`: all else waits there for its place."""
    for about in ABOUT:
        template = about.parent
        if template.name == "start":  # it has no regions: Copier asks before it writes over them
            continue
        own = {about, template / "questions.yml", template / ANSWERS_FILE}
        for path in {path for path in template.rglob("*") if not path.is_dir()} - own:
            place = path.relative_to(template)
            waits = place.parts[:3] == (".eddi", "new", "{{ stage }}")
            assert waits or place.as_posix() == ".eddi/new/.gitignore.jinja", path
