"""The shared oracle of ConSerts, and its documents as files."""

from functools import cache
from typing import Any

import yaml

from eddi_scaffold.common.files import Source
from tests.data_files import data_file


@cache
def oracle() -> dict[str, Any]:
    path = data_file("conserts/oracle.yml")
    data = yaml.load(path.read_bytes(), Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))
    return dict(data)


def as_source(document: Any, name: str = "model.yml") -> Source:
    text = document if isinstance(document, str) else yaml.safe_dump(document, sort_keys=False)
    return Source(name, text.encode())
