"""Each diagnostic of reliability: a model that earns it, and its exact text.

The cases stand in ``diagnostics.txt``: a ``reliability_config.yml``, or an Open-PSA file, or else,
where it begins with ``<``, the failure models of an EDDI.
"""

import re
from pathlib import Path
from typing import Any

import pytest

from eddi_scaffold.common.problems import EddiError, Problem, in_order
from eddi_scaffold.deployments.checking import check_files
from eddi_scaffold.kinds import Options
from eddi_scaffold.kinds.reliability.system import TYPES
from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.platforms.ros1 import monitor_answers
from tests.data_files import data_text
from tests.diagnosed import Cases
from tests.kinds.reliability.monitors import everything, models_of
from tests.kinds.reliability.test_reliability_example import EXAMPLE

CASES = Cases(Path(__file__).with_name("diagnostics.txt"))
PACKAGE = "//@odeProductPackages.0/@failureModels"
HEAD = data_text("reliability/head.xml")


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


@pytest.mark.parametrize("name", CASES.inputs)
def test_text_of_the_diagnostic(name: str, tmp_path: Path) -> None:
    text = CASES.inputs[name]
    if text.startswith("<") and not text.startswith("<opsa-mef>"):
        problems = of_eddi(text, tmp_path)
    else:
        problems = everything(text, *["tree.xml"] * text.startswith("<"))
    codes = re.findall(r"[RX]\d{3}(?=_)", name)
    assert {*codes} <= {problem.code for problem in problems}
    CASES.check(name, problems)


def said(folder: Path, old: str, new: str) -> list[str]:
    text = (EXAMPLE / "reliability_config.yml").read_text("utf-8")
    assert text.count(old) >= 1
    config = folder / "config.yml"
    config.write_text(text.replace(old, new, 1), "utf-8")
    problems = check_files([EXAMPLE / "drone.xml", config])
    return [f"{p.place.line}:{p.place.col} {p.code} {p.message} | {p.hint}" for p in problems]


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        (
            "{Link:",
            "{Lnk:",
            "11:16 R001 there is no event of 'MissionLoss' 'Lnk' | did you mean 'Link'?",
        ),
        (
            "{observed: true}",
            "{observed: maybe}",
            "11:33 R002 observed: true or false is expected | None",
        ),
        (
            "Rotors:",
            "Rotrs:",
            (
                "8:5 R001 model 'Rotrs' has no type | models: Rotors, MissionLoss; or write "
                f"`type:` and one of {', '.join(TYPES)}"
            ),
        ),
    ],
)
def test_only_the_cause_is_said(tmp_path: Path, old: str, new: str, expected: str) -> None:
    assert said(tmp_path, old, new) == [expected]


def test_an_input_that_nobody_provides_in_words_of_this_kind(tmp_path: Path) -> None:
    text = (EXAMPLE / "reliability_config.yml").read_text("utf-8")
    entry = text[text.index("  - id: MissionLoss_Link") : text.index("EDDIOutputs")]
    (one,) = said(tmp_path, entry, "")
    assert "K014 no entry of EDDIInputs provides 'MissionLoss_Link': it stays unknown, and " in one
    assert "p_fail is the worst case of it, and not valid" in one


def test_no_threshold_trusts_a_tree_with_an_open_port(tmp_path: Path) -> None:
    path = tmp_path / "model.xml"
    path.write_text(data_text("reliability/open_port.xml"))
    models, problems = models_of(path)
    assert [(one.level, one.code) for one in problems] == [("warning", "X014")]
    assert models["T"].configure(Options())[0] is not None
    options = Options(values={"thresholds": [{"id": "go", "activate": 0.1}]})
    configured, problems = models["T"].configure(options)
    assert configured is None
    (one,) = problems
    assert (one.code, one.place.line) == ("R005", 10)
    assert one.message == (
        "port 'Port' has no input: what it represents is left out, so that no threshold may "
        "trust p_fail of 'T'"
    )


THRESHOLD = "- {id: RtE_continue, at_most: 1.0e-4, release: 2.0e-4, hold: 1 s"


def answers(folder: Path, topic: str) -> tuple[Any, list[str]]:
    text = (EXAMPLE / "reliability_config.yml").read_text("utf-8")
    config = folder / "c.yml"
    config.write_text(text.replace(THRESHOLD, f"{THRESHOLD}, topic: {topic}"), "utf-8")
    (monitor,), _ = monitors_of(EXAMPLE / "drone.xml", [config])
    package, problems = monitor_answers(monitor)
    return package.answers, [f"{p.place.line}: {p.code} {p.message}" for p in problems]


def test_a_topic_carries_one_type_and_is_not_heard(tmp_path: Path) -> None:
    """Outside of namespaces, ``/drone/reliability`` is the example's ``drone/reliability``."""
    both = "eddi_messages/ReliabilityOutput and std_msgs/Bool"
    assert answers(tmp_path, "/drone/reliability")[1] == [
        f"13: K031 the topic /drone/reliability would carry {both}"
    ]
    with pytest.raises(EddiError) as heard:
        answers(tmp_path, "drone/rotors_ok")
    assert [problem.code for problem in heard.value.problems] == ["D001"]
