"""Stand-alone state machines in JSON, as EDDI-Editor imports them.

Commas behind last elements and comments are read, because people write them; a key that is not
known, or stands twice, is an error. No library reads such JSON and tells where values stand.
"""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from typing import TypeAlias, TypeVar

from eddi_scaffold.common.files import Source
from eddi_scaffold.common.problems import EddiError, Place, Problem, SimilarNames, problem
from eddi_scaffold.eddi_xml.parsing import HEAD_BYTES, Element, new_element

_TOKEN = re.compile(
    r"(?P<blank>(?:[ \t\r\n]+|//[^\n]*|/\*[\s\S]*?\*/)*)"
    r'(?:(?P<sign>[][{}:,])|(?P<text>"(?:[^"\\\x00-\x1f]|\\.)*")'
    r"|(?P<plain>-?(?:0|[1-9]\d*)(?:\.\d+)?(?:[eE][-+]?\d+)?(?![\w.])|(?:true|false|null)\b)"
    r"|(?P<other>\w+|[^\n])|)"
)
_NO_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_KINDS = {dict: "an object", list: "a list", str: "a text in quotes", bool: "true or false"}
_T = TypeVar("_T")
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
    with source.open() as stream:
        return re.search(rb'"(?:states|transitions)"\s*:\s*\[', stream.read(HEAD_BYTES)) is not None


def read_machine(source: Source) -> tuple[Element | None, dict[Element, Place], list[Problem]]:
    """Return the model that EDDI-Editor makes of a machine, places of its elements, problems."""
    reader = _Reader()
    try:
        model = reader.model(_Parser(source.text("X001"), source.name).document())
    except EddiError as failure:
        return None, {}, list(failure.problems)
    return (None if reader.problems else model), reader.places, reader.problems


@dataclass(frozen=True)
class _Value:
    content: str | bool | list[_Value] | _Entries | None  # None: a number, or null
    place: Place


_Entries: TypeAlias = dict[str, tuple[Place, _Value]]  # with the place of the key


class _Parser:
    def __init__(self, text: str, file: str) -> None:
        self.text, self.file = text, file
        self.at = self.line = self.line_start = 0
        self.place = Place(file, 1, 1)  # of the token
        self.sign = self.written = ""  # of the token: itself, or what it is; as it is written

        self._next()

    def document(self) -> _Value:
        value = self._value(0)
        if self.sign:
            raise self._fault("the end of the file")
        return value

    def _next(self) -> None:
        """Go to the next token; its sign is empty at the end of the file."""
        match = _TOKEN.match(self.text, self.at)
        assert match is not None  # the last alternative is nothing, at the end
        start = match.end("blank")
        self.line += self.text.count("\n", self.at, start)
        if (end := self.text.rfind("\n", self.at, start)) >= 0:
            self.line_start = end + 1
        self.place = Place(self.file, self.line + 1, start - self.line_start + 1)
        self.at, self.written = match.end(), match[0][start - match.start() :]
        kind = match.lastgroup or ""
        self.sign = match["sign"] or ("" if kind == "blank" else kind)
        if self.sign == "other":
            raise self._fault("a value")

    def _fault(self, expected: str) -> EddiError:
        actual = f"`{self.written[:40]}`" if self.written else "the end of the file"
        return EddiError(problem("X001.json", self.place, expected=expected, actual=actual))

    def _take(self, *signs: str) -> None:
        if self.sign not in signs:
            raise self._fault(" or ".join(f"`{sign}`" for sign in signs))
        self._next()

    def _value(self, depth: int) -> _Value:
        place, sign, written = self.place, self.sign, self.written
        if depth > 16:
            raise self._fault("at most 16 lists and objects in each other")
        if sign == "text":
            return _Value(self._text(), place)
        if sign not in ("{", "[", "plain"):
            raise self._fault("a value")
        self._next()
        if sign == "plain":
            return _Value({"true": True, "false": False}.get(written), place)
        items: list[_Value] = []
        entries: _Entries = {}
        close = "]" if sign == "[" else "}"
        while self.sign != close:
            if sign == "[":
                items.append(self._value(depth + 1))
            else:
                at, key = self.place, self._text()
                self._take(":")
                before, _ = entries.setdefault(key, (at, self._value(depth + 1)))
                if before is not at:
                    raise EddiError(problem("X011.twice", at, feature=key, line=before.line))
            if self.sign != close:
                self._take(",", close)
        self._next()
        return _Value(items if sign == "[" else entries, place)

    def _text(self) -> str:
        if self.sign != "text":
            raise self._fault("a text in quotes")
        try:
            text = str(json.loads(self.written))
        except ValueError:
            raise self._fault("a text with the escapes of JSON") from None
        if _NO_XML.search(text):
            raise self._fault("a text without control characters")
        self._next()
        return text


class _Reader:
    """Builds what EDDI-Editor makes of a machine."""

    def __init__(self) -> None:
        self.places: dict[Element, Place] = {}
        self.problems: list[Problem] = []

    def model(self, value: _Value) -> Element:
        model = parent = self._add(None, "Model", value)
        for tag in ("SystemElements", "System", "failureModels"):
            parent = self._add(parent, tag, value)
        entries = self._object(value, "the machine")
        names = {"name": self._get(entries, "name", str, "")}
        machine = self._add(parent, "StateMachine", value, **names)
        states = self._add(machine, "States", value)
        for each in self._get(entries, "states", list, []):
            fields = self._object(each, "a state", "name")
            state = self._add(states, "State", each, name=self._get(fields, "name", str, ""))
            for key, attribute in (("start", "isInitialState"), ("fail", "isFailState")):
                text = str(fields[key][1].content).lower() if key in fields else "false"
                is_flag = text in ("true", "false")  # "True" counts in the tool, too
                state.set(attribute, text if is_flag else str(self._get(fields, key, bool, False)))
            actions = self._add(state, "OnEntry", each)
            for item in self._get(fields, "onentry", list, []):
                parts = self._object(item, "an action", "function")  # whatever its `type`
                function = self._get(parts, "function", str, "")
                names = {"name": self._get(parts, "name", str, function), "function": function}
                self._add(actions, "FunctionAction", item, **names)
        transitions = self._add(machine, "Transitions", value)
        for each in self._get(entries, "transitions", list, []):
            fields = self._object(each, "a transition", "from", "to")
            ends = {key: self._get(fields, key, str, "") for key in ("from", "to")}
            name = self._get(fields, "name", str, " -> ".join(ends.values()))
            transition = self._add(transitions, "Transition", each, name=name)
            for key, tag in (("from", "fromState"), ("to", "toState")):
                if key in fields:
                    self._add(transition, tag, fields[key][1], name=ends[key])
            triggers = self._add(transition, "triggers", each)
            texts = self._get(fields, "trigger", str, "").split(";")
            for text in filter(None, map(str.strip, texts)):
                names = {"name": f"Condition={text}", "condition": text}
                self._add(triggers, "ConditionEvent", fields["trigger"][1], **names)
        return model

    def _add(self, parent: Element | None, tag: str, value: _Value, **texts: str) -> Element:
        element = new_element(tag, parent, texts)
        self.places[element] = value.place
        return element

    def _object(self, value: _Value, owner: str, *required: str) -> _Entries:
        keys, place, content = _KEYS[owner], value.place, value.content
        if not isinstance(content, dict):
            self.problems.append(problem("X011.json", place, subject=owner, allowed=_KINDS[dict]))
            return {}
        for key in sorted(set(required) - content.keys()):
            self.problems.append(problem("X010.attribute", place, attribute=key, owner=owner))
        for key, (at, _) in content.items():
            if key not in keys:
                hint = SimilarNames(keys, "keys").hint(key)
                self.problems.append(problem("X011.key", at, hint=hint, key=key, owner=owner))
        return content

    def _get(self, entries: _Entries, key: str, kind: type[_T], default: _T) -> _T:
        """Return the value of a key, the default where it is absent or of another kind."""
        if key not in entries:
            return default
        value = entries[key][1]
        if not isinstance(value.content, kind):
            fields = {"subject": f"`{key}`", "allowed": _KINDS[kind]}
            self.problems.append(problem("X011.json", value.place, **fields))
            return default
        return value.content
