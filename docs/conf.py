"""Settings of Sphinx for the site: every page of the repository, as it stands on GitHub.

The source folder is the repository itself, so that links to examples, to CONTRIBUTING.md and to
the README are those that people follow on GitHub. The contents are the lists of ``docs/index.md``.
"""

from __future__ import annotations

import contextlib
import io
import os
import re
from pathlib import Path

from sphinx.application import Sphinx

from eddi_scaffold.cli.app import COMMANDS, app
from eddi_scaffold.common.catalogue import areas

project = "eddi-scaffold"
author = "The eddi-scaffold team"
extensions = ["myst_parser"]
include_patterns = [
    "*.md",
    "docs/**.md",
    "eddi_scaffold/regions/README.md",
    "examples/*/README.md",
]
exclude_patterns = [".*", "build", "tests", "copier_templates", "examples/*/expected"]
root_doc = "docs/index"
html_theme = "furo"
html_title = project
myst_heading_anchors = 4  # those of GitHub
nitpicky = True


def setup(application: Sphinx) -> None:
    """Register what is added to pages, and the file that a web server asks for."""
    application.connect("source-read", _add)
    application.connect("build-finished", _first_page)


def _add(_: Sphinx, name: str, text: list[str]) -> None:
    added = {
        root_doc: _contents,
        "docs/reference/options": _options,
        "docs/reference/diagnostics": _diagnostics,
    }
    if name in added:
        text[0] += added[name](text[0])


def _contents(page: str) -> str:
    """Return a table of contents for each section of the first page: the pages that it links to."""
    tables = []
    for title, section in re.findall(r"(?ms)^## ([^\n]+)\n(.*?)(?=^## |\Z)", page):
        pages = re.findall(r"(?m)^- \[[^]]*\]\(([^)#]+)\.md\)", section)
        tables += ["", "```{toctree}", f":caption: {title}", ":hidden:", *pages, "```"]
    return "\n".join(tables)


def _options(_: str) -> str:
    """Return the help of each command, without the options that all have."""
    os.environ["COLUMNS"] = "80"
    sections = []
    for title, group in COMMANDS.items():
        sections.append(f"\n## {title}\n")
        for name in group:
            printed = io.StringIO()
            with contextlib.redirect_stdout(printed):
                app([name, "--help"], prog_name="eddi-scaffold", standalone_mode=False)
            text, _, _ = printed.getvalue().partition("  -q, --quiet ")
            sections.append(f"### {name}\n\n```text\n{text.strip()}\n```\n")
    return "\n".join(sections)


def _diagnostics(_: str) -> str:
    """Return a section for each code: why, what to do, and what is printed."""
    parts = []
    for area in areas():
        parts += [f"## {area.letter}: {area.title}", area.about]
        for entry in area.diagnostics.values():
            parts += [f"### {entry.code} {entry.title}", f"*{', '.join(entry.levels)}*"]
            parts += [entry.why, f"What to do: {entry.fix}"]
            parts.append("\n".join(["```text", *entry.shown(), "```"]))
    return "\n\n".join(["", *parts])


def _first_page(application: Sphinx, failure: Exception | None) -> None:
    """Write an ``index.html`` at the top, which a web server asks for."""
    if failure is None and application.builder.format == "html":
        page = f'<meta http-equiv="refresh" content="0; url={root_doc}.html">\n'
        (Path(application.outdir) / "index.html").write_text(page, encoding="utf-8")
