"""Versions of eddi-scaffold, as packages and the shelf of the templates record them."""

from __future__ import annotations

from eddi_scaffold import __version__


def is_newer(version: str) -> bool:
    """Return whether a version is of a later release than this one; no version is none."""
    try:
        return release(version) > release(__version__)
    except ValueError:
        return False


def release(version: str) -> tuple[int, ...]:
    """Return the numbers of a version.

    Raises:
        ValueError: it is not made of numbers.
    """
    return tuple(int(part) for part in version.strip().split("."))
