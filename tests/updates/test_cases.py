"""The cases of hand edits as data: each key of a step is a method of ``_Player``.

The long profile runs each case with each command, the others take the commands in turn: they differ
in how a rendering arrives, which ``test_with_copier.py`` shows on each platform.
"""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from subprocess import CalledProcessError
from typing import Any

import pytest
import yaml

from eddi_scaffold.regions.marked_file import parse
from tests.updates.inputs import inputs_of
from tests.updates.lives import histories
from tests.updates.templates import Templates, git
from tests.updates.world import World

pytestmark = pytest.mark.slow
_FILE = Path(__file__).parents[1] / "data/oracles/edits/cases.yml"
CASES: list[dict[str, Any]] = yaml.load(_FILE.read_text(), yaml.CSafeLoader)
_OURS = ("generate", "upgrade")


def _runs() -> list[Any]:
    """Return the cases with the commands for which they are run."""
    runs = []
    for number, case in enumerate(CASES):
        lists = [step["do"] for step in case["steps"] if isinstance(step.get("do"), list)]
        commands = lists[0] if lists else [None]
        turn = number % len(commands[:3])  # an update renders three times
        runs += [
            pytest.param(case, command, id=f"{case['id']}-{command or 'own'}")
            for command in commands[histories(turn, 0) : histories(turn + 1, 4)]
        ]
    return runs


@pytest.mark.parametrize(("case", "command"), _runs())
def test_case(
    case: dict[str, Any], command: str | None, folder: Path, templates: Templates
) -> None:
    player = _Player(World(folder, templates, inputs_of(case["inputs"])), command)
    player.world.begin()
    player.play(case["steps"])


class _Player:
    def __init__(self, world: World, command: str | None) -> None:
        self.world = world
        self.command = command
        self.before: dict[Path, bytes] = {}
        self.linked: dict[str, bytes] = {}

    def play(self, steps: list[dict[str, Any]]) -> None:
        for step in steps:
            word, value = next(iter(step.items()))
            act: Callable[[Any], None] = getattr(self, f"_{word}")
            act(step if word == "do" else value)

    # commands

    def _do(self, step: Mapping[str, Any]) -> None:
        command = self.command if isinstance(step["do"], list) else step["do"]
        assert command is not None
        if "inputs" in step:
            self.world.inputs = inputs_of(step["inputs"])
        self.world.template = step.get("template", self.world.template)
        self.before = self._bytes()
        done = self.world.run(command, step.get("flags", ()))
        status = step["status"]
        if command in _OURS:
            assert done.status == status, done.said
        else:
            assert (done.status == 0) == (status in {0, 3}), done.said
        for word in step.get("says", ()):
            assert word in done.said, done.said

    def _check(self, value: Mapping[str, Any]) -> None:
        done = self.world.command("regions", "--check", self.world.package)
        assert done.status == value["status"], done.said
        for word in value.get("says", ()):
            assert word in done.said, done.said

    def _accept(self, ids: list[str]) -> None:
        words = [word for one in ids for word in ("--accept", one)]
        done = self.world.command("regions", self.world.package, *words)
        assert done.status == 0, done.said

    # a person

    def _body(self, value: Mapping[str, str]) -> None:
        self.world.put(value["region"], value["text"], value.get("file", "EDDIInput.py"))

    def _replace(self, value: Mapping[str, str]) -> None:
        text, old = self.world.text(value["file"]), value["old"]
        if "Manual edit" in old:  # a marker line may go on with digests
            pattern = "".join(f"{re.escape(line)}[^\n]*\n" for line in old.splitlines())
            found = re.findall(pattern, text)
            assert len(found) == 1, found
            old = found[0]
        assert text.count(old) == 1, (old, text)
        self.world.file(value["file"]).write_bytes(text.replace(old, value["new"]).encode())

    def _append(self, value: Mapping[str, str]) -> None:
        text = self.world.text(value["file"]) + value["text"]
        self.world.file(value["file"]).write_bytes(text.encode())

    def _new_file(self, value: Mapping[str, str]) -> None:
        place = self.world.file(value["beside"]).with_name(value["file"])
        place.write_text(value["text"])

    def _remove(self, name: str) -> None:
        self.world.remove(name)

    def _empty_kept(self, _: object) -> None:
        self.world.remove(".eddi/kept")

    def _delete_region(self, value: Mapping[str, str]) -> None:
        one, text = self.world.region(value["region"]), self.world.text("EDDIInput.py")
        whole = f"{one.begin}\n{one.body}{one.end}\n"
        assert text.count(whole) == 1
        place = self.world.file("EDDIInput.py")
        place.write_text(text.replace(whole, value["put"]))

    def _duplicate_method(self, value: Mapping[str, str]) -> None:
        text = self.world.text("EDDIInput.py")
        method = text[text.index(f"    def {value['of']}(") :]
        method = method[: method.index("\n    def ", 5) + 1]
        copy = method.replace(f"def {value['of']}(", f"def {value['as']}(")
        self.world.file("EDDIInput.py").write_text(text.replace(method, method + copy))

    def _exchange_regions(self, ids: list[str]) -> None:
        one, other = (self.world.region(id_) for id_ in ids)
        text = self.world.text("EDDIInput.py")
        first, second = (f"{r.begin}\n{r.body}{r.end}\n" for r in (one, other))
        text = text.replace(first, "FIRST").replace(second, first).replace("FIRST", second)
        self.world.file("EDDIInput.py").write_text(text)

    def _d72_markers(self, value: Mapping[str, str]) -> None:
        text = self.world.text(value["file"])
        bare = re.sub(r"(?m)^( *'''-----Manual edit \w+-----''').*$", r"\1", text)
        self.world.file(value["file"]).write_text(bare)

    def _link(self, value: Mapping[str, str]) -> None:
        place = self.world.file(value["file"])
        target = self.world.folder / value["file"]
        place.rename(target)
        place.symlink_to(target)
        self.linked[value["file"]] = target.read_bytes()

    # git

    def _commit(self, _: object) -> None:
        self.world.commit()

    def _clone(self, kind: str) -> None:
        self.world = self.world.clone(*(["core.autocrlf=true"] if kind == "crlf" else []))

    def _branches(self, value: Mapping[str, list[dict[str, Any]]]) -> None:
        world = self.world
        git(world.workspace, "branch", "theirs")
        inputs, template = world.inputs, world.template
        for name in ("ours", "theirs"):
            world.inputs, world.template = inputs, template
            if name == "theirs":
                git(world.workspace, "checkout", "-q", "theirs")
            self.play(value[name])
            world.commit()
        git(world.workspace, "checkout", "-q", "main")
        with suppress(CalledProcessError):  # conflicts stay
            git(world.workspace, "merge", "-q", "theirs")

    # what must hold

    def _has(self, value: Mapping[str, Any]) -> None:
        text = self.world.text(value["file"])
        for word in value["text"]:
            assert word in text, text

    def _lacks(self, value: Mapping[str, Any]) -> None:
        text = self.world.text(value["file"])
        for word in value["text"]:
            assert word not in text, text

    def _count(self, value: Mapping[str, Any]) -> None:
        assert self.world.text(value["file"]).count(value["text"]) == value["times"]

    def _anywhere(self, words: list[str]) -> None:
        texts = [data.decode("utf-8", "replace") for data in self._bytes().values()]
        for word in words:
            assert any(word in text for text in texts)

    def _body_is(self, value: Mapping[str, str]) -> None:
        name = value.get("file", "EDDIInput.py")
        assert self.world.region(value["region"], name).body == value["text"]

    def _body_like(self, value: Mapping[str, str]) -> None:
        body = self.world.region(value["region"]).body
        assert body.replace("\r\n", "\n").strip("\n") == value["text"].strip("\n")

    def _kept(self, ids: list[str]) -> None:
        assert self.world.kept() == sorted(ids)

    def _unchanged(self, names: list[str]) -> None:
        for name in names:
            place = self.world.file(name)
            assert place.read_bytes() == self.before[place]

    def _target_unchanged(self, value: Mapping[str, str]) -> None:
        name = value["file"]
        assert self.world.file(name).is_symlink()
        assert (self.world.folder / name).read_bytes() == self.linked[name]

    def _line_ends(self, value: Mapping[str, str]) -> None:
        data = self.world.file(value["file"]).read_bytes()
        assert data.count(b"\r\n") == (data.count(b"\n") if value["are"] == "crlf" else 0)
        assert not parse(data.decode())[1]

    def _imports(self, _: object) -> None:
        self.world.imports()
        shutil.rmtree(self.world.package / "__pycache__", ignore_errors=True)

    def _bytes(self) -> dict[Path, bytes]:
        paths = self.world.package.rglob("*")
        return {path: path.read_bytes() for path in paths if path.is_file()}
