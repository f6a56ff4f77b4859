"""Default guarantees marked from outside: ``--default-guarantee [CONSERT/]ID``.

Source: DEIS 2019 knows default guarantees, which hold always; neither the EDDI nor the YAML of
SESAME D7.2 can mark them, and not everybody may change the file.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from eddi_scaffold.common.problems import Place, Problem, did_you_mean, problem
from eddi_scaffold.yaml_text.nodes import shown

if TYPE_CHECKING:
    from collections.abc import Sequence

    from eddi_scaffold.kinds.consert.model import ConSert


def with_default_guarantees(
    conserts: Sequence[ConSert], marks: Sequence[str], file: str = ""
) -> tuple[tuple[ConSert, ...], list[Problem]]:
    """Mark guarantees as default ones, before the ConSerts are checked.

    Args:
        conserts: all ConSerts of a file.
        marks: ``ID``, or ``CONSERT/ID`` where several ConSerts have that id.
        file: the file, for messages.

    Returns:
        The ConSerts with their marks; an error (C008) for each mark that fits none or several.
    """
    chosen: set[tuple[str, str]] = set()
    problems: list[Problem] = []
    for mark in dict.fromkeys(marks):
        found = _named(conserts, mark)
        if len(found) == 1:
            chosen.add(found[0])
        else:
            problems.append(_unclear(conserts, mark, found, Place(file)))
    return tuple(_marked(consert, chosen) for consert in conserts), problems


def marks_elsewhere(files: Sequence[Sequence[ConSert]], marks: Sequence[str]) -> set[str]:
    """Return what is said of marks that a file lacks and another one of these files has.

    Args:
        files: the ConSerts of each file.
        marks: all that were given.
    """
    return {_unknown(mark) for mark in marks if any(_named(conserts, mark) for conserts in files)}


def _all(conserts: Sequence[ConSert]) -> list[tuple[str, str]]:
    return [(consert.name, g.id) for consert in conserts for g in consert.guarantees]


def _named(conserts: Sequence[ConSert], mark: str) -> list[tuple[str, str]]:
    pairs = dict.fromkeys(_all(conserts))
    exact = [pair for pair in pairs if "/".join(pair) == mark]
    return exact or [pair for pair in pairs if pair[1] == mark]


def _unclear(
    conserts: Sequence[ConSert], mark: str, found: Sequence[tuple[str, str]], place: Place
) -> Problem:
    if found:
        names = " or ".join("/".join(pair) for pair in found)
        return problem("C008.several", place, mark=mark, names=names)
    known = [name for pair in _all(conserts) for name in (pair[1], "/".join(pair))]
    return problem(
        "C008.no_guarantee", place, hint=did_you_mean(mark, known), mark=mark, guarantee=shown(mark)
    )


def _unknown(mark: str) -> str:
    return f"--default-guarantee {mark}: there is no guarantee {shown(mark)}"


def _marked(consert: ConSert, chosen: set[tuple[str, str]]) -> ConSert:
    if not any(name == consert.name for name, _ in chosen):
        return consert
    guarantees = tuple(
        replace(g, default=True) if (consert.name, g.id) in chosen else g
        for g in consert.guarantees
    )
    return replace(consert, guarantees=guarantees)
