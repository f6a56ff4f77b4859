"""A package follows from its own configuration and model: never from others, or from an order."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml

from tests.cli.command import Result, run
from tests.data_files import ORACLES
from tests.package_texts import facts_in

_ALL: list[dict[str, Any]] = yaml.load((ORACLES / "users/order.yml").read_text(), yaml.CSafeLoader)[
    "cases"
]
CASES = [case for case in _ALL if case["id"] != "documents"]  # several configurations in one file
WORKSPACE = Path("src/eddi_monitor")


def _generate(case: dict[str, Any], configs: list[str], target: Path) -> Result:
    for name, text in case["files"].items():
        (target.parent / name).write_text(text, "utf-8")
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


def test_who_maintains_what_is_shared_does_not_rest_on_the_order(tmp_path: Path) -> None:
    case = next(case for case in CASES if case["id"] == "reader_first")
    files = {
        name: text + ("Package: {maintainer: Ada <ada@example.org>}\n" if "ferry_" in name else "")
        + ("Package: {maintainer: Bob <bob@example.org>}\n" if "wind_" in name else "")
        for name, text in case["files"].items()
    }  # fmt: skip
    found = set()
    for number, commands in enumerate(case["sequences"][2:4]):
        target = tmp_path / str(number)
        for configs in commands:
            assert _generate({**case, "files": files}, configs, target).status == 0
        found.add((_root(case, target) / "eddi_messages/package.xml").read_text("utf-8"))
    (text,) = found
    assert "ada@example.org" in text


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
    assert "write `max_age: 5` in its entry" in last.err
    # what it says is the way out
    text = SLOW["files"]["ferry_config.yml"]
    assert "field: active}" in text
    mended = text.replace("field: active}", "field: active, max_age: 5}")
    again = {**SLOW, "files": {**SLOW["files"], "ferry_config.yml": mended}}
    for config in ("ferry_config.yml", "wind_config.yml"):
        done = _generate(again, [config], tmp_path / "ws")
        assert done.status == 0, done.err
