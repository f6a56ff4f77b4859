"""Where a generated catkin package keeps its model, seen from one of its own Python files."""

from pathlib import Path
from typing import Iterable, List

__all__ = ["NoModelFileError", "find_model"]

_MODEL = Path("config", "model.json")


class NoModelFileError(Exception):
    """No model file lies where the package should have it; the text names the places."""


def find_model(file: str, package: str) -> Path:
    """Return ``config/model.json`` of the package that a file belongs to.

    Args:
        file: ``__file__`` of ``RosNode.py`` or of a module of the package, in the source tree
            (from where the devel space runs, too) or in the install space.
        package: name of the catkin package.

    Raises:
        NoModelFileError: with every place that was tried.
    """
    tried = list(dict.fromkeys(_places(file, package)))
    for path in tried:
        if path.is_file():
            return path
    raise NoModelFileError("no model file: " + " nor ".join(str(path) for path in tried))


def _places(file: str, package: str) -> Iterable[Path]:
    folder = Path(file).resolve().parent
    yield folder / _MODEL.name  # a plain package
    above: List[Path] = list(folder.parents)
    if folder.name != package:
        yield from (root / _MODEL for root in above[:1])  # <root>/scripts
        return
    if above[0].name == "src":
        yield from (root / _MODEL for root in above[1:2])  # <root>/src/<package>
    for prefix in (*above[1:2], *above[3:4]):  # <prefix>/lib, <prefix>/lib/python3/dist-packages
        yield prefix / "share" / package / _MODEL
