"""Monitors together: robots, rings, and what a monitor reads of another one by way of others."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml

from eddi_scaffold.common.problems import EddiError, Problem
from eddi_scaffold.deployments.support import Deployment, WiredMonitor, facts_of_package, wired
from eddi_scaffold.deployments.wiring import check_wiring
from eddi_scaffold.packages.assembly import monitors_of
from eddi_scaffold.platforms import chosen
from tests.cli.command import Result, edit, run
from tests.data_files import ORACLES, data_text, write_files
from tests.package_texts import facts_in

CONSERT = data_text("deployments/consert.yml")
CONFIG = data_text("deployments/consert_config.yml")


def member(
    folder: Path, id_: str, topic: str, sources: str, input_: str, namespace: str = ""
) -> WiredMonitor:
    (folder / f"{id_}.yml").write_text(CONSERT.format(), "utf-8")
    config = folder / f"{id_}_config.yml"
    text = CONFIG.format(id=id_, sources=sources, input=input_, topic=topic)
    config.write_text(text, "utf-8")
    (monitor,), _ = monitors_of(None, [config])
    return wired(monitor, namespace)


def codes(problems: list[Problem]) -> list[str]:
    return [problem.code for problem in problems]


SENSOR = "  - {id: s, type: std_msgs.Bool, topic: /fine}"


@pytest.mark.parametrize(("topic", "expected"), [("/base/out", ["D005"]), ("base/out", [])])
def test_two_robots_share_an_absolute_topic(
    topic: str, expected: list[str], tmp_path: Path
) -> None:
    robots = [
        member(tmp_path, "base", topic, SENSOR, "requires: [s]", f"/robot{number}")
        for number in (1, 2)
    ]
    assert codes(check_wiring(robots)) == expected


def test_a_relative_topic_stays_with_its_robot(tmp_path: Path) -> None:
    base = [member(tmp_path, "base", "base/out", SENSOR, "requires: [s]", f"/r{k}") for k in (1, 2)]
    guarantee = "  - {id: b, type: eddi_messages.ConSertOutput, topic: base/out}"
    field = "requires: [b], field: 'guarantees[G].active'"
    user = member(tmp_path, "user", "user/out", guarantee, field, "/r2")
    together = Deployment([*base, user])
    (source,) = user.config.config.SimulatorOutputs
    found = together.publisher(user, source)
    assert found is not None
    assert found[0] is base[1]


def test_a_value_alone_is_not_read(tmp_path: Path) -> None:
    """A guarantee on a std_msgs topic: false is also UNKNOWN there, whatever it is read for."""
    member(tmp_path, "base", "base/out", SENSOR, "requires: [s]")
    path = tmp_path / "base_config.yml"
    alone = "{id: g, topic: base/g, field: 'guarantees[G].active'}"
    edit(path, "EDDIOutputs: [", f"EDDIOutputs: [{alone}, ")
    base = wired(monitors_of(None, [path])[0][0])
    source = "  - {id: g, type: std_msgs.Bool, topic: base/g}"
    good = member(tmp_path, "good", "good/out", source, "requires: [g]")
    bad = member(tmp_path, "bad", "bad/out", source, 'expression: "NOT g.data"')
    for reader in (good, bad):
        assert [one.case for one in check_wiring([base, reader])] == ["D001.alone"]
        assert codes(check_wiring([base], [reader])) == ["D001"]
        assert base.bound is not None
        there = facts_of_package("base", chosen("ros1").monitor(base.bound)[0].answers)
        assert there is not None
        assert codes(check_wiring([reader], [there])) == ["D001"], "also of a package that is there"


def test_class_names_are_the_ids_that_others_read(tmp_path: Path) -> None:
    """With ``guarantee_ids: class``, also around a ring and where the id of the model is used."""
    ring = []
    for name, other in (("a", "b"), ("b", "a")):
        (tmp_path / f"{name}.yml").write_text(CONSERT.format().replace("G", "all_fine"), "utf-8")
        source = f"  - {{id: s, type: eddi_messages.ConSertOutput, topic: {other}/out}}"
        text = CONFIG.format(
            id=name,
            sources=source,
            input="requires: [s], field: 'guarantees[AllFine].active'",
            topic=f"{name}/out",
        )
        path = tmp_path / f"{name}_config.yml"
        path.write_text(text.replace("type: ConSert", "type: ConSert, guarantee_ids: class"))
        ring.append(path)
    with pytest.raises(EddiError) as refused:
        monitors_of(None, ring)
    assert codes(list(refused.value.problems)) == ["D003"]
    edit(ring[0], "AllFine", "all_fine")
    with pytest.raises(EddiError) as refused:
        monitors_of(None, ring)
    assert "b publishes no 'all_fine'" in str(refused.value)


def test_silence_is_followed_through_another_input(tmp_path: Path) -> None:
    """An expression that turns another input round turns what that one reads round."""
    member(tmp_path, "base", "base/out", SENSOR, "requires: [s]")
    names = ("turned.events", "turned_config.yml")
    write_files(tmp_path, {name: data_text(f"deployments/{name}") for name in names})
    with pytest.raises(EddiError) as refused:
        monitors_of(None, [tmp_path / "base_config.yml", tmp_path / names[1]])
    (problem,) = refused.value.problems
    assert (problem.code, problem.message.partition(" by ")[0]) == (
        "D001", "input 'g' gains from silence",
    )  # fmt: skip


_TEXT = (ORACLES / "users/order.yml").read_text()
CASES: list[dict[str, Any]] = yaml.load(_TEXT, yaml.CSafeLoader)["cases"]
WORKSPACE = Path("src/eddi_monitor")


def _generate(case: dict[str, Any], configs: list[str], target: Path) -> Result:
    write_files(target.parent, case["files"])
    target.mkdir(exist_ok=True)
    place = ["-w" if case["platform"] == "ros1" else "-o", target]
    given = [word for config in configs for word in ("-c", config)]
    return run("generate", "--platform", case["platform"], *place, *given, cwd=target.parent)


def _files(folder: Path) -> Iterator[tuple[str, bytes]]:
    for path in folder.rglob("*"):
        if path.is_file():
            yield str(path.relative_to(folder)), path.read_bytes()


def _root(case: dict[str, Any], target: Path) -> Path:
    return target / WORKSPACE if case["platform"] == "ros1" else target


@pytest.mark.parametrize("case", CASES, ids=[case["id"] for case in CASES])
def test_every_order_makes_the_same_files(case: dict[str, Any], tmp_path: Path) -> None:
    made = []
    for number, commands in enumerate(case["sequences"]):
        target = tmp_path / str(number)
        for configs in commands:
            done = _generate(case, configs, target)
            assert done.status == case.get("status", 0), done.err
            assert case.get("code", "") in done.err
            assert case.get("says", "") in done.err
        root = _root(case, target)
        packages = case.get("packages", ["."])
        made.append({one: dict(_files(root / one)) for one in packages})
        for package, wanted in case.get("contains", {}).items():
            for what, seconds in wanted.items():
                assert _age(root / package, what.removeprefix("max_age of ")) == seconds
                if case["platform"] == "ros1":  # a plain program knows no messages, only values
                    assert f"{seconds} s" in (root / package / "README.md").read_text("utf-8")
    assert all(one == made[0] for one in made)


def _age(package: Path, input_: str) -> float | str | None:
    """Return the limit of an input, which the compiled monitor and the model have alike."""
    (age,) = (entry.max_age for entry in facts_in(package).inputs if entry.id == input_)
    (compiled,) = package.rglob("compiled.py")
    (line,) = (one for one in compiled.read_text().splitlines() if f'InputSpec("{input_}"' in one)
    assert f"max_age={age}" in line
    return age


SLOW = next(case for case in CASES if case["id"] == "slow_publisher")


@pytest.mark.parametrize("order", [[0, 1], [1, 0]])
def test_a_slow_publisher_is_told_whichever_of_both_comes_last(
    order: list[int], tmp_path: Path
) -> None:
    (configs,) = SLOW["sequences"][0]
    first, last = (_generate(SLOW, [configs[number]], tmp_path / "ws") for number in order)
    assert (first.status, last.status) == (0, 2), last.err
    assert "input 'Calm' is unknown after 1 s, but wind publishes only every 2 s" in last.err
    assert "write `max_age: 4 s` or more in its entry" in last.err
    # what it says is the way out
    text = SLOW["files"]["ferry_config.yml"]
    assert "field: active}" in text
    mended = text.replace("field: active}", "field: active, max_age: 5}")
    again = {**SLOW, "files": {**SLOW["files"], "ferry_config.yml": mended}}
    for config in ("ferry_config.yml", "wind_config.yml"):
        done = _generate(again, [config], tmp_path / "ws")
        assert done.status == 0, done.err
