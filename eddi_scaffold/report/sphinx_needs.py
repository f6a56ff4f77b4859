"""Items as ``needs.json``, which sphinx-needs 9 imports (``needimport``)."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from datetime import datetime

from eddi_scaffold import __version__
from eddi_scaffold.common.escaping import one_line, python_literal
from eddi_scaffold.report.items import KINDS, Item, export_ids

_FIELDS = ("place", "sha256")
_MARKUP = re.compile(r"[^\w\s]|_")  # with a backslash before it, Sphinx shows it as it is
# What Sphinx must be told before it imports the file.
_CONF = """\
project = {project}
extensions = ["sphinx_needs"]
needs_types = [
    {{"directive": kind, "title": kind, "prefix": "", "color": "#BFD8D2", "style": "node"}}
    for kind in {kinds}
]
needs_fields = {{
    name: {{"schema": {{"type": "string"}}, "nullable": True}} for name in {fields}
}}
"""


def needs_json(project: str, items: Sequence[Item], created: datetime) -> str:
    """Return the items for sphinx-needs."""
    ids = export_ids(item.key for item in items)
    needs = {
        ids[item.key]: {
            "id": ids[item.key],
            "type": item.key[0],
            "title": item.key[2],
            "content": _MARKUP.sub(r"\\\g<0>", one_line(item.text)),
            "status": item.state,
            "tags": ["eddi"],
            "links": [ids[key] for keys in item.links.values() for key in keys],
            **{name: getattr(item, name) for name in _FIELDS if getattr(item, name)},
        }
        for item in items
    }
    at = created.isoformat()
    creator = {"program": "eddi-scaffold", "version": __version__}
    version = {"created": at, "creator": creator, "needs": needs, "needs_amount": len(needs)}
    document = {
        "created": at,
        "current_version": "1.0",
        "project": project,
        "versions": {"1.0": version},
    }
    return json.dumps(document, indent=1, ensure_ascii=False) + "\n"


def needs_conf(project: str) -> str:
    """Return the ``conf.py`` with which Sphinx imports the items without a warning."""
    values = {"project": project, "kinds": KINDS, "fields": _FIELDS}
    return _CONF.format(**{name: python_literal(value) for name, value in values.items()})
