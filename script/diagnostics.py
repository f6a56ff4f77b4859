#!/usr/bin/env python3
"""Bring the examples in the registry and ``docs/reference/diagnostics.md`` up to date.

    script/diagnostics.py    # after a change of common/catalogue/areas or of a snapshot

Examples come from the snapshots, exact texts that the tests compare with what is printed. One that
is still in a snapshot stays as it is; any other becomes the first problem of that code there. A
code in no snapshot is left unchanged: a test with ``assert_example`` proves its example.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from eddi_scaffold.common.catalogue import AREAS, areas  # noqa: E402 - of this checkout

PAGE = ROOT / "docs" / "reference" / "diagnostics.md"
_PROBLEM = re.compile(
    r"(?m)^(?:\S.*?: )?(?:error|warning|info): .+ \[([A-Z]\d{3})\]\n(?:    .*\n)*(?:  hint: .+\n)?"
)
_HEAD = """# Diagnostics

<!-- written by script/diagnostics.py from eddi_scaffold/common/catalogue/areas -->

Every problem has a stable code; its wording may change. `eddi-scaffold explain K007` prints the
section of a code, with `--json` for programs. An *error* stops each command that would write, a
*warning* does not, an *info* is shown with `--verbose`. The examples are printed by tests.

"""


def snapshots() -> Iterator[str]:
    """Yield the texts that the tests compare with what is printed."""
    tests = ROOT / "tests"
    for path in sorted([*tests.rglob("diagnostics.txt"), *tests.rglob("diagnostics/*.txt")]):
        yield path.read_text("utf-8")


def printed() -> dict[str, list[str]]:
    """Return code -> its problems in the snapshots, those of cases with its name first."""
    found: dict[str, list[tuple[bool, str]]] = {}
    for text in snapshots():
        for case in re.split(r"(?m)^### ", text):
            for match in _PROBLEM.finditer(f"{case}\n"):
                other = not case.startswith(match[1])
                found.setdefault(match[1], []).append((other, match[0].rstrip("\n")))
    return {
        code: [text for _, text in sorted(problems, key=lambda one: one[0])]
        for code, problems in found.items()
    }


def with_examples(area: str, known: dict[str, list[str]]) -> str:
    """Return the text of an area with its examples from the snapshots."""
    head, *sections = re.split(r"(?m)^(?=## )", area)
    return head + "".join(_section(one, known.get(one[3:7], [])) for one in sections)


def _section(section: str, known: list[str]) -> str:
    text, _, lines = section.rstrip().partition("\n\n    ")
    example = re.sub(r"(?m)^    ", "", lines)
    if known and not any(example in one for one in known if example):
        example = known[0]
    indented = re.sub(r"(?m)^(?=.)", "    ", example)
    return f"{text}\n\n{indented}\n\n"


def document() -> str:
    """Return the page of all areas."""
    rows = [
        f"| [{area.letter}](#{_anchor(f'{area.letter}: {area.title}')}) | {area.title} |"
        f" {len(area.diagnostics)} |"
        for area in areas()
    ]
    table = "\n".join(["| letter | about | codes |", "|---|---|---|", *rows])
    texts = (path.read_text("utf-8") for path in sorted(AREAS.glob("*.md")))
    sections = "\n\n".join(re.sub(r"(?m)^(?=##? )", "#", text.rstrip()) for text in texts)
    return f"{_HEAD}{table}\n\n{sections}\n"


def _anchor(title: str) -> str:
    """Return what GitHub makes of a heading."""
    return re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-")


def main() -> None:
    """Write the areas and the page."""
    known = printed()
    for path in AREAS.glob("*.md"):
        text = with_examples(path.read_text("utf-8"), known)
        path.write_text(f"{text.rstrip()}\n", "utf-8")
    areas.cache_clear()
    PAGE.write_text(document(), "utf-8")


if __name__ == "__main__":
    main()
