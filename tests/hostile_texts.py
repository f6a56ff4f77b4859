"""Texts that want to be code, in every language that is generated."""

from __future__ import annotations

import json

from tests.data_files import data_text

HOSTILE: list[str] = json.loads(data_text("hostile_texts.json"))
