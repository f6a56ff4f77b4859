"""Each diagnostic of reliability: a model that earns it, and its exact text.

The cases stand in ``diagnostics.txt``: ``### NAME``; a ``reliability_config.yml``, or an Open-PSA
file, or else, where it begins with ``<``, the failure models of an EDDI; ``>>>``; what is reported.
``UPDATE_DIAGNOSTICS=1`` writes what is reported now.
"""

import os
import re
from pathlib import Path

import pytest

from eddi_scaffold.common.problems import Problem, in_order
from eddi_scaffold.kinds import Options
from tests.kinds.reliability.monitors import everything, models_of

FILE = Path(__file__).with_name("diagnostics.txt")
CASES = dict(part.split("\n", 1) for part in re.split(r"(?m)^### ", FILE.read_text("utf-8"))[1:])
PACKAGE = "//@odeProductPackages.0/@failureModels"
HEAD = """<?xml version="1.0" encoding="UTF-8"?>
<i:DDIPackage xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"
 xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
 xmlns:f="http://www.deis-project.eu/ode/failureLogic"
 xmlns:i="http://www.deis-project.eu/ode/integration">
<odeProductPackages xsi:type="f:FailureLogicPackage">
"""


def reported(given: str, folder: Path) -> str:
    if given.startswith("<opsa-mef>"):
        problems = everything(given, "tree.xml")
    else:
        problems = of_eddi(given, folder) if given.startswith("<") else everything(given)
    return "".join(
        f"{Path(p.place.file).name}:{p.place.line}{f':{p.place.col}' if p.place.col else ''}: "
        f"{p.level}: {p.message} [{p.code}]\n" + (f"  hint: {p.hint}\n" if p.hint else "")
        for p in problems
    )


def of_eddi(given: str, folder: Path) -> list[Problem]:
    """Lines count from the first one of the case."""
    body = given.replace("$", PACKAGE)
    text = HEAD.replace("\n", " ").rstrip() + body + "</odeProductPackages></i:DDIPackage>\n"
    path = folder / "model.xml"
    path.write_text(text.replace("?> <i", "?><i"), "utf-8")
    models, problems = models_of(path)
    for model in models.values():
        problems += model.check()
        problems += model.configure(Options())[1]
    return in_order(problems)


@pytest.mark.parametrize("name", CASES)
def test_text_of_the_diagnostic(name: str, tmp_path: Path) -> None:
    given, _, expected = CASES[name].partition(">>>\n")
    got = reported(given, tmp_path)
    if os.environ.get("UPDATE_DIAGNOSTICS"):
        text = FILE.read_text("utf-8")
        old = f"### {name}\n{CASES[name]}"
        FILE.write_text(text.replace(old, f"### {name}\n{given}>>>\n{got}"), "utf-8")
        return
    assert got == expected
    codes = re.findall(r"[RX]\d{3}(?=_)", name)
    assert all(f"[{code}]" in got for code in codes)
