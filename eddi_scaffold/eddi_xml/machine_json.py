"""Stand-alone state machines in JSON, as EDDI-Editor imports them.

Read as YAML, of which JSON is a part: so commas behind last elements pass, as in that tool, and
every value has a place. Comments are blanked before; an unknown or repeated key is an error.
"""

from __future__ import annotations

import re

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import EddiError, Place, Problem, problem
from eddi_scaffold.eddi_xml.parsing import HEAD_BYTES, Element, new_element
from eddi_scaffold.yaml_text.nodes import Items, Map, Node, as_text, items_of, read_document

_TEXT_OR_BLANK = re.compile(r'("(?:[^"\\]|\\.)*")|//[^\n]*|/\*[\s\S]*?\*/|\t')
_NO_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_KEYS = {
    "the machine": ("name", "states", "transitions"),
    "a state": ("name", "position", "colour", "start", "fail", "onentry"),
    "an action": ("name", "type", "function"),
    "a transition": ("name", "from", "to", "trigger"),
}


def is_machine(source: Source) -> bool:
    """Return whether a file is the JSON of a stand-alone machine, by its name and its keys."""
    if not source.name.lower().endswith(".json"):
        return False
    head = source.data[:HEAD_BYTES]
    return re.search(rb'"(?:states|transitions)"\s*:\s*\[', head) is not None


def read_machine(source: Source) -> tuple[Element | None, dict[Element, Place], list[Problem]]:
    """Return the model that EDDI-Editor makes of a machine, places of its elements, problems."""
    try:
        text = _TEXT_OR_BLANK.sub(
            lambda m: m[1] or re.sub(r"[^\n]", " ", m[0]), source.text("X001")
        )
    except EddiError as failure:
        return None, {}, list(failure.problems)
    node, problems = read_document(Source(source.name, text.encode()), "X001")
    reader = _Reader(problems)
    model = None if node is None else reader.model(node)
    return (None if reader.problems else model), reader.places, reader.problems


class _Reader:
    """Builds what EDDI-Editor makes of a machine."""

    def __init__(self, problems: list[Problem]) -> None:
        self.problems = problems
        self.places: dict[Element, Place] = {}

    def model(self, node: Node) -> Element:
        model = parent = self._add(None, "Model", node)
        for tag in ("SystemElements", "System", "failureModels"):
            parent = self._add(parent, tag, node)
        entries = self._object(node, "the machine")
        machine = self._add(parent, "StateMachine", node, name=self._text(entries, "name"))
        states = self._add(machine, "States", node)
        for each in self._items(entries, "states"):
            fields = self._object(each, "a state", "name")
            state = self._add(states, "State", each, name=self._text(fields, "name"))
            for key, attribute in (("start", "isInitialState"), ("fail", "isFailState")):
                state.set(attribute, self._flag(fields, key))
            actions = self._add(state, "OnEntry", each)
            for item in self._items(fields, "onentry"):
                parts = self._object(item, "an action", "function")  # whatever its `type`
                function = self._text(parts, "function")
                names = {"name": self._text(parts, "name") or function, "function": function}
                self._add(actions, "FunctionAction", item, **names)
        transitions = self._add(machine, "Transitions", node)
        for each in self._items(entries, "transitions"):
            fields = self._object(each, "a transition", "from", "to")
            ends = {key: self._text(fields, key) for key in ("from", "to")}
            name = self._text(fields, "name") or " -> ".join(ends.values())
            transition = self._add(transitions, "Transition", each, name=name)
            for key, tag in (("from", "fromState"), ("to", "toState")):
                if key in fields:
                    self._add(transition, tag, fields[key], name=ends[key])
            triggers = self._add(transition, "triggers", each)
            for text in filter(None, map(str.strip, self._text(fields, "trigger").split(";"))):
                names = {"name": f"Condition={text}", "condition": text}
                self._add(triggers, "ConditionEvent", fields["trigger"], **names)
        return model

    def _add(self, parent: Element | None, tag: str, node: Node, **texts: str) -> Element:
        element = new_element(tag, parent, texts)
        self.places[element] = node.place
        return element

    def _object(self, node: Node, owner: str, *required: str) -> dict[str, Node]:
        if not isinstance(node, Map):
            self._wrong(node, owner, "an object")
            return {}
        keys = _KEYS[owner]
        for key in sorted(set(required).difference(node.keys())):
            self.problems.append(problem("X010.attribute", node.place, attribute=key, owner=owner))
        for name, _ in node.entries:
            if name.text not in keys:
                hint = f"keys: {', '.join(keys)}"
                fields = {"key": name.text, "owner": owner}
                self.problems.append(problem("X011.key", name.place, hint=hint, **fields))
        return {name.text: value for name, value in node.entries}

    def _wrong(self, node: Node, subject: str, allowed: str) -> None:
        self.problems.append(problem("X011.json", node.place, subject=subject, allowed=allowed))

    def _items(self, entries: dict[str, Node], key: str) -> tuple[Node, ...]:
        node = entries.get(key, Items(()))
        if not isinstance(node, Items):
            self._wrong(node, f"`{key}`", "a list")
        return items_of(node)

    def _text(self, entries: dict[str, Node], key: str) -> str:
        if key not in entries:
            return ""
        text = as_text(entries[key])
        if text is None or _NO_XML.search(text):
            self._wrong(entries[key], f"`{key}`", "a text without control characters")
            return ""
        return text

    def _flag(self, entries: dict[str, Node], key: str) -> str:
        """Return true or false; "True" in quotes counts in the tool, too."""
        text = (as_text(entries[key]) or "").lower() if key in entries else "false"
        if text not in ("true", "false"):
            self._wrong(entries[key], f"`{key}`", "true or false")
        return text
