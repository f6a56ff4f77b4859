"""Turn design-time EDDIs into runtime monitors, and keep regenerating them."""

from __future__ import annotations

import sys
from importlib.machinery import ModuleSpec
from importlib.util import spec_from_file_location
from pathlib import Path

__version__ = "1.0.0"


class _OwnRuntime:
    """Import the runtime library that belongs to the generator, whatever else is on the path.

    In a terminal with a sourced workspace ``PYTHONPATH`` leads to that of the workspace, which has
    only what its monitors need, and may be of another version.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = str(folder)

    def find_spec(self, name: str, path: object = None, target: object = None) -> ModuleSpec | None:
        """Return where the library is; its modules are found from there."""
        if name != "eddi_runtime":
            return None
        file = f"{self._folder}/__init__.py"
        return spec_from_file_location(name, file, submodule_search_locations=[self._folder])


_beside = Path(__file__).parent.parent
for _place in (_beside / "eddi_runtime", _beside / "runtime_lib/src/eddi_runtime"):
    if (_place / "__init__.py").is_file():  # installed, or in a checkout
        sys.meta_path.insert(0, _OwnRuntime(_place))
        break
