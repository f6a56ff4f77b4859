"""What is accepted in place of a known value: shown before, said by the monitor while in use."""

import json
from pathlib import Path

from eddi_runtime.history import EDDIInputBase

from eddi_scaffold.packages.assembly import monitors_of
from tests.cli.command import edit, run
from tests.data_files import data_text, tabled
from tests.deployments.wiring.test_wiring import CONSERT

CONFIG = data_text("deployments/accepting_config.yml")
LIMITLESS = ", requires: [s], field: data, max_age: none"
UNSAFE = ", requires: [s], field: data, max_age: 1.0, default: true, allow_unsafe_default: true"


def written(folder: Path, entry: str, more: str = ", parameters: [{model: base.yml}]") -> Path:
    (folder / "base.yml").write_text(CONSERT.format(), "utf-8")
    config = folder / "base_config.yml"
    config.write_text(CONFIG.format(input=entry, more=more), "utf-8")
    return config


@tabled
def test_the_monitor_is_told_what_it_cannot_see(entry, keys, tmp_path):
    (monitor,), _ = monitors_of(None, [written(tmp_path, entry)])
    (spec,) = monitor.compiled.monitor(monitor.id).inputs
    assert [*spec.accepts] == keys


@tabled
def test_infinity_is_accepted_by_whoever_writes_it(expression, keys, tmp_path):
    entry = f", expression: {json.dumps(expression)}, max_age: 1.0"
    config = written(tmp_path, entry)
    edit(config, "std_msgs.Bool", "sensor_msgs.LaserScan")
    (monitor,), _ = monitors_of(None, [config])
    (spec,) = monitor.compiled.monitor(monitor.id).inputs
    assert [*spec.accepts] == keys
    checked = run("check", "base_config.yml", "base.yml", cwd=tmp_path)
    assert ("[D009]" in checked.err) == bool(keys), checked.err


class Message:
    data = True


def test_a_default_is_in_use_until_the_first_message(tmp_path: Path) -> None:
    config = written(tmp_path, UNSAFE)
    (made,), _ = monitors_of(None, [config])
    monitor = made.compiled.monitor(made.id)
    told = EDDIInputBase()
    vars(told)["E"] = True  # as the generated class begins
    told.bind(monitor.inputs)

    def step(messages: dict[str, object]) -> tuple[object, object]:
        told.begin_step({"s": 0.0})
        told.update("E", lambda m: setattr(told, "E", m.data), messages, ["s"])
        (row,) = monitor.execute_step(told)
        return row["active"], monitor.status_message()[1]["accepted"]

    assert step({}) == (True, ["E: allow_unsafe_default: true"])
    assert step({"s": Message()}) == (True, [])
    assert step({}) == (False, [])


SAID = "input 'E' of Base, `max_age: none`: Base.G rests on the last value of /fine for ever"


def test_show_of_a_configuration_lists_it(tmp_path: Path) -> None:
    written(tmp_path, LIMITLESS)
    for words in (["base_config.yml"], ["base.yml", "-c", "base_config.yml"]):
        shown = run("show", *words, cwd=tmp_path)
        assert (shown.status, shown.out.splitlines()[-2:]) == (0, ["accepted:", f"  {SAID}"])
        (row,) = json.loads(run("show", *words, "--json", cwd=tmp_path).out)["accepted"]
        assert (row["key"], row["topics"], row["claims"]) == (
            "max_age: none", ["/fine"], ["Base.G"],
        )  # fmt: skip


@tabled
def test_show_of_a_configuration_that_cannot_be(words, status, code, tmp_path):
    good = written(tmp_path, ", requires: [s], field: data, max_age: 1.0", "")
    wrong = good.read_text("utf-8").replace("field: data", "field: nope")
    (tmp_path / "wrong.yml").write_text(wrong, "utf-8")
    shown = run("show", *words, cwd=tmp_path)
    assert (shown.status, f"[{code}]" in shown.err) == (status, True), shown.err
