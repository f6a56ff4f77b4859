"""The file of the model that a configuration names."""

from __future__ import annotations

from pathlib import Path

from eddi_scaffold.config.file import ConfigFile, about_file
from eddi_scaffold.problems import EddiError, error
from eddi_scaffold.source import beside, near_file

MODEL_KEYS = ("model", "config", "file")
_Keys = tuple[str | int, ...]


def named_model(file: ConfigFile) -> str | None:
    """Return the file that ``parameters`` names as the model, relative to the configuration.

    SESAME D7.2 writes ``parameters: [{config: safeml_config.yml}]``.
    """
    found = _named_model(file)
    return None if found is None else found[0]


def named_model_path(file: ConfigFile) -> Path | None:
    """Return where the file is that ``parameters`` names, ``None`` where it names none.

    Raises:
        EddiError: there is no such file (F001), or it is not below the folder of the configuration
            (F009); the place is that of its name.
    """
    found = _named_model(file)
    if found is None:
        return None
    name, where = found
    try:
        path = beside(file.name, name)
        path.stat()
    except EddiError as failure:
        raise EddiError(
            *(about_file(p, name, file.place(*where)) for p in failure.problems)
        ) from None
    except (OSError, ValueError):
        near = near_file(path, name, Path(file.name).name)
        hint = near or "a name is relative to the folder of the configuration"
        message = f"there is no file {name!r}"
        raise EddiError(error("F001", message, file.place(*where), hint)) from None
    return path


def _named_model(file: ConfigFile) -> tuple[str, _Keys] | None:
    """Return the name of the model's file and the keys under which it is given."""
    given = file.config.Model.parameters
    where: _Keys = ("Model", "parameters")
    maps = [((*where, k), one) for k, one in enumerate(given)] if isinstance(given, list) else []
    for key in MODEL_KEYS:
        for keys, one in maps or [(where, given)]:
            name = one.get(key) if isinstance(one, dict) else None
            if isinstance(name, str) and name:
                return name, (*keys, key)
    return None
