"""Random lives of a package: every hand-written line stays where it belongs, whatever happens."""

from __future__ import annotations

import os
import random
import re
import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple
from unittest.mock import patch
from xml.etree import ElementTree as ET

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from eddi_scaffold.regions.bases import bases_of
from eddi_scaffold.regions.check import broken_files
from eddi_scaffold.regions.marked_file import Region, parse
from eddi_scaffold.regions.result import Orphan
from eddi_scaffold.regions.store import load_orphans
from eddi_scaffold.regions.sync import SyncReport, sync_package
from tests.regions.rendering import (
    CMAKE,
    FILES,
    INPUT,
    MANIFEST,
    NETWORK,
    Element,
    Package,
    elements,
    render,
    snapshot,
)

pytestmark = pytest.mark.slow

NAMES = ("speed", "Distance_to_Pedestrian", "Critical", "light", "gps", "wind")
STATES = (("Yes", "No"), ("low", "mid", "high"), ("Yes", "No", "Maybe"))


class Killed(BaseException):
    """Stands for kill -9: nothing catches it."""


class Tool(NamedTuple):
    """What merges: ours, or the package of its own."""

    sync: Callable[[Path], SyncReport]
    saved: Callable[[Path], dict[Path, Orphan]]
    check: Callable[[Path], object]


OURS = Tool(sync_package, load_orphans, broken_files)


class Life:
    """One package, its person and what must be true of it."""

    records = ".eddi"

    def __init__(self, root: Path, chance: random.Random, tool: Tool | None = None) -> None:
        self.root, self.chance, self.tool = root, chance, tool or OURS
        self.package = Package(elements(*NAMES[:3]))
        self.inside: dict[str, set[str]] = {}  # token -> ids under which its region was known
        self.outside: dict[str, str] = {}  # token -> function that holds it, "" for anywhere
        self.replaced: list[str] = []  # tokens in generated lines, of the base too
        self.count = 0
        self.crlf = False
        self.update(kill=False)

    # what happens -------------------------------------------------------------------------
    def act(self, name: str, *, kill: bool) -> None:
        getattr(self, name)()
        self.update(kill=kill)
        self.check()

    def add(self) -> None:
        have = [e.name for e in self.package.elements]
        free = [name for name in NAMES if name not in have]
        if free:
            place = self.chance.randint(0, len(have))
            new = Element(self.chance.choice(free), self.chance.choice(STATES))
            self._set(*self.package.elements[:place], new, *self.package.elements[place:])

    def remove(self) -> None:
        if self.package.elements:
            gone = self.chance.choice(self.package.elements)
            self._set(*(e for e in self.package.elements if e != gone))

    def rename(self) -> None:
        have = [e.name for e in self.package.elements]
        free = [name for name in NAMES if name not in have]
        if have and free:
            old, new = self.chance.choice(self.package.elements), self.chance.choice(free)
            for ids in self.inside.values():
                for kind in ("input", "node"):
                    if f"{kind}:{old.name}" in ids:
                        ids.add(f"{kind}:{new}")
            now = replace(old, name=new, was=(old.name,))
            self._set(*(now if e == old else e for e in self.package.elements))

    def reorder(self) -> None:
        order = list(self.package.elements)
        self.chance.shuffle(order)
        self._set(*order)

    def retype(self) -> None:
        if self.package.elements:
            one = self.chance.choice(self.package.elements)
            now = replace(one, states=self.chance.choice(STATES))
            self._set(*(now if e == one else e for e in self.package.elements))

    def template(self) -> None:
        self.package = replace(self.package, version=self.chance.choice((1, 2, 3)))

    def files(self) -> None:
        gone = self.chance.choice((None, NETWORK, CMAKE))
        self.package = replace(self.package, files=tuple(f for f in FILES if f != gone))

    def both(self) -> None:
        self.template()
        getattr(self, self.chance.choice(("add", "remove", "rename", "reorder", "retype")))()

    def nothing(self) -> None:
        pass

    def edit(self) -> None:
        path = self.chance.choice([f for f in FILES if (self.root / f).exists()])
        document, faults = parse(self._text(path))
        assert not faults
        regions = list(document.regions.values())
        if not regions:
            return
        region = self.chance.choice(regions)
        token = self._token()
        self.inside[token] = {region.id}
        code = self.chance.choice(
            (
                f"{token} = 1",
                f"if True:\n    {token} = 2\nelse:\n    pass",
                f'{token} = """\n  text\nflush left\n"""',
            )
        )
        if path == CMAKE:
            code = f"set({token} 1)"
        if path == MANIFEST:
            code = f"<depend>{token}</depend>"
        lines = "".join(f"{region.indent}{line}\n" for line in code.split("\n"))
        if '"""' in code:
            lines = lines.replace(f"{region.indent}flush", "flush")
        keep = self.chance.random() < 0.7
        if not keep:
            for old in re.findall(r"hand_\d+", region.body):
                self.inside.pop(old, None)
        self._put(path, document.parts, region, (region.body if keep else "") + lines)

    def edit_outside(self) -> None:
        token = self._token()
        text = self._text(INPUT)
        place = self.chance.choice(("import", "helper", "init", "behind", "docstring", "last"))
        functions = re.findall(r"def (process_\w+)", text)
        if place == "import":
            text = text.replace("\n\nclass", f"\nimport {token}\n\n\nclass", 1)
        elif place == "helper":
            helper = f"\n    def {token}(self):\n        # about {token}\n        return 1\n"
            text = text.replace("\n    def processing", f"{helper}\n    def processing", 1)
        elif place == "init":
            text = re.sub(
                r"(\n    def (?!__init__))", rf"        self.{token} = 1\n\1", text, count=1
            )
        elif place == "behind" and functions:
            name = self.chance.choice(functions)
            ident = re.escape(name.removeprefix("process_"))
            quotes = r"(?:'''|\"{3})"  # a formatter's stay
            end = rf"(edit end-----{quotes}  # region: input:{ident}\n)"
            text, written = re.subn(end, rf"\1        self.{token} = 1\n", text, count=1)
            assert written, name
            self.outside[token] = name
        elif place == "docstring":
            text = text.replace('"""\n', f'\n\n{token}\n"""\n', 1)
        elif place == "last":
            text += f"        self.{token}()\n"
        if token in text:
            self.outside.setdefault(token, "")
        self._write(INPUT, text)

    def edit_elsewhere(self) -> None:
        token = self._token()
        path = self.chance.choice([f for f in FILES if (self.root / f).exists()])
        text = self._text(path)
        nodes = re.findall(r"def (node_\w+)", text)
        if path == MANIFEST:
            text = text.replace(
                "<name>pkg</name>", f"<name>pkg</name>\n  <license>{token}</license>"
            )
        elif path == CMAKE:
            text += f"\nmessage({token})\n"
        elif nodes:
            name = self.chance.choice(nodes)
            start, _, rest = text.partition(f"def {name}(")
            found = rest.replace(
                "is_bn_output = False\n", f"is_bn_output = False\n        {token} = 1\n", 1
            )
            text = f"{start}def {name}({found}"
            self.outside[token] = name
        if token in text:
            self.outside.setdefault(token, "")
        self._write(path, text)

    def replace(self) -> None:
        """Change a generated line in the records, too."""
        token, bases = self._token(), self.root / self.records / "bases"
        base = bases_of(bases.read_text())[INPUT]
        known = {line for line in base.splitlines() if "Manual edit" not in line}
        line = self.chance.choice([one for one in self._text(INPUT).splitlines() if one in known])
        for path in (self.root / INPUT, bases):
            old = rf"(?m)^ ?{re.escape(line)}(?=\r?$)"
            text = re.sub(old, lambda found: f"{found[0]}  # {token}", path.read_bytes().decode())
            path.write_bytes(text.encode())
        self.replaced.append(token)

    def damage(self) -> None:
        path = self.chance.choice([f for f in FILES if (self.root / f).exists()])
        text = self._text(path)
        lines = text.split("\n")
        marked = [i for i, line in enumerate(lines) if "Manual edit" in line]
        if not marked:
            return
        at = self.chance.choice(marked)
        lines[at : at + 1] = self.chance.choice(([], [lines[at]] * 2, [lines[at] + " x"]))
        self._write(path, "\n".join(lines))
        raw = (self.root / path).read_bytes()
        report = self.tool.sync(self.root)
        assert {r.file for r in report.refused} == {path}
        assert (self.root / path).read_bytes() == raw
        self._write(path, text)

    def format(self) -> None:
        text = self._text(INPUT)
        if '= """' not in text:
            self._write(INPUT, text.replace("'", '"'))

    def line_ends(self) -> None:
        self.crlf = not self.crlf
        self._write(INPUT, self._text(INPUT))

    # the world ----------------------------------------------------------------------------
    def rendered(self) -> None:
        render(self.root, self.package, self.records)

    def update(self, *, kill: bool) -> None:
        self.rendered()
        if kill:
            self._killed_sync()
        report = self.tool.sync(self.root)
        assert not report.refused, report
        before = snapshot(self.root)
        again = self.tool.sync(self.root)
        assert snapshot(self.root) == before
        assert again.touched == ()
        assert not again.needs_attention, again

    def _killed_sync(self) -> None:
        left = self.chance.randint(0, 12)
        real = {name: getattr(os, name) for name in ("replace", "unlink")}

        def guard(name: str):
            def step(*arguments: object, **options: object) -> object:
                nonlocal left
                left -= 1
                if left < 0:
                    raise Killed
                return real[name](*arguments, **options)

            return step

        for name in real:
            setattr(os, name, guard(name))
        try:
            self.tool.sync(self.root)
        except Killed:
            pass
        finally:
            for name, function in real.items():
                setattr(os, name, function)
        if self.chance.random() < 0.5:  # the next rendering comes before the repair
            getattr(self, self.chance.choice(("add", "remove", "template", "reorder")))()
            self.rendered()

    # what must be true --------------------------------------------------------------------
    def check(self) -> None:
        present = [f for f in FILES if (self.root / f).exists()]
        assert present == [f for f in FILES if f in self.package.files]
        texts = {path: self._text(path) for path in present}
        bodies: dict[str, Region] = {}
        outside = ""
        for path, text in texts.items():
            assert "<<<<<<<" not in text
            if path.endswith(".py"):
                compile(text, path, "exec")
            if path.endswith(".xml"):
                ET.fromstring(text)
            document, faults = parse(text)
            assert not faults
            bodies.update(document.regions)
            outside += "".join(p for p in document.parts if isinstance(p, str))
        raw = (self.root / INPUT).read_bytes()
        assert (raw.count(b"\r\n") == raw.count(b"\n")) == self.crlf
        orphans = list(self.tool.saved(self.root).values())
        rejects = "".join(
            p.read_bytes().decode() for p in (self.root / self.records).glob("rejects/**/*.patch")
        )
        kept = [*texts.values(), *(orphan.body for orphan in orphans)]
        kept += [p.read_text() for p in (self.root / self.records).glob("rejects/**/*.edited")]
        for token in self.replaced:
            assert any(token in text for text in kept), token
        everything = "\n".join(texts.values())
        for token, ids in self.inside.items():
            word = re.compile(rf"\b{token}\b")
            homes = [r.id for r in bodies.values() if word.search(r.body)]
            saved = [o.id for o in orphans if word.search(o.body)]
            assert len(homes) + len(saved) >= 1, (token, ids)
            assert len(homes) <= 1, (token, homes)
            assert set(homes + saved) <= ids, (token, homes, saved, ids)
            assert not word.search(outside)
            assert sum(len(word.findall(r.body)) for r in bodies.values()) <= 1
        for token, function in self.outside.items():
            word = re.compile(rf"\b{token}\b")
            found = list(word.finditer(everything))
            assert found or word.search(rejects), token
            assert len(found) <= 2
            if found and function:
                above = everything[: found[0].start()]
                assert re.findall(r"def (\w+)", above)[-1] == function

    # small helpers ------------------------------------------------------------------------
    def _set(self, *new: Element) -> None:
        self.package = replace(self.package, elements=new)

    def _token(self) -> str:
        self.count += 1
        return f"hand_{self.count}"

    def _text(self, path: str) -> str:
        return (self.root / path).read_bytes().decode().replace("\r\n", "\n")

    def _write(self, path: str, text: str) -> None:
        data = text.replace("\n", "\r\n") if self.crlf and path == INPUT else text
        (self.root / path).write_bytes(data.encode())

    def _put(self, path: str, parts: tuple[str | Region, ...], region: Region, body: str) -> None:
        out = []
        for part in parts:
            if isinstance(part, str):
                out.append(part)
            else:
                inner = body if part is region else part.body
                out.append(f"{part.begin}\n{inner}{part.end}\n")
        self._write(path, "".join(out))


PERSON = ("edit", "edit", "edit", "edit_outside", "edit_outside", "edit_elsewhere")
MODEL = ("add", "remove", "rename", "reorder", "retype", "both", "nothing")
ACTIONS = (*PERSON, *MODEL, "template", "files", "line_ends", "damage", "format", "replace")


@settings(deadline=None, suppress_health_check=list(HealthCheck))
@given(
    actions=st.lists(st.tuples(st.sampled_from(ACTIONS), st.booleans()), min_size=8, max_size=16),
    seed=st.integers(0, 10**6),
)
@example(actions=[("format", False), *[("edit_outside", False)] * 12], seed=0)
def test_no_life_loses_moves_or_doubles_a_line(actions: list[tuple[str, bool]], seed: int) -> None:
    with tempfile.TemporaryDirectory() as folder, patch("os.fsync"):  # a kill is no power cut
        life = Life(Path(folder), random.Random(seed))
        for action, kill in actions:
            life.act(action, kill=kill)


def test_report_of_an_untouched_package_is_empty(tmp_path: Path) -> None:
    render(tmp_path, Package(elements("a", "b")))
    assert sync_package(tmp_path) == SyncReport()
