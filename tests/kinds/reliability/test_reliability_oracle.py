"""The oracle: every case with its correct value."""

from dataclasses import replace
from functools import cache
from typing import Any

import pytest
import yaml
from eddi_runtime.thresholds import Evidence, Threshold

from eddi_scaffold.common.units import rate
from eddi_scaffold.kinds import Options
from eddi_scaffold.kinds.reliability.reliability_model import ReliabilityModel
from tests.data_files import data_file
from tests.kinds.reliability.monitors import at_start, everything, models_of, sound


@cache
def oracle() -> dict[str, Any]:
    text = data_file("monitors/oracle_safedrones.yml").read_text("utf-8")
    found: dict[str, Any] = yaml.load(text, yaml.CSafeLoader)
    return found


def check(result: Any, case: dict[str, Any]) -> None:
    assert result.valid
    assert result.p_fail == pytest.approx(case["correct_P_fail"], rel=1e-12, abs=0.0)
    assert result.mttf == pytest.approx(case["correct_MTTF"], rel=1e-12, abs=0.0)


def alone(type_: str, hours: object = 1, **keys: object) -> str:
    """Return a configuration with the model ``m`` and nothing else."""
    shown = ", ".join(f"{key}: {value}" for key, value in {"type": type_, **keys}.items())
    return f"horizon: {hours} h\nmodels: {{m: {{{shown}}}}}\n"


def test_motors() -> None:
    for case in oracle()["motor"]:
        count, name = len(case["status"]), case["configuration"]
        rates = f"[{', '.join([str(case['lambda']) + ' 1/h'] * count)}]"
        text = alone("propulsion", case["t"], configuration=name, rates=rates)
        if case.get("correct") == "config_error":
            assert len(name) != count
            assert [one.code for one in everything(text)] == ["R005"]
            continue
        status = {f"m_motor_{i}": bool(works) for i, works in enumerate(case["status"])}
        check(at_start(sound(text), **status), case)


def test_batteries() -> None:
    for case in oracle()["battery"]:
        names = {"failure_rate": "L", "alpha": "a", "beta": "b", "degradation": "d"}
        rates = {name: f"{case[letter]} 1/h" for name, letter in names.items()}
        model = sound(alone("battery", case["t"] or 1, **rates))
        # a configuration must look ahead; the numbers hold for no time at all, too
        model = replace(model, data=replace(model.data, horizon=float(case["t"])))
        result = at_start(model, m_level=case["level"])
        if "correct_P_fail" in case:
            check(result, case)
        else:
            assert result.unknown == ("m_level",)
            assert not result.valid


def test_processors() -> None:
    for case in oracle()["processor"]:
        keys = {"mttf_ref": f"{case['MTTFref']} h", "t_ref": f"{case['Tr']} degC"}
        keys |= {"t_max": "90 degC", "u_max": 2, "shape": case["b"]}
        model = sound(alone("processor", case["t"], **keys))
        check(at_start(model, m_temperature=case["Ta"], m_utilisation=case["u"]), case)


def test_satellites() -> None:
    for case in oracle()["gps"]:
        rate_ = f"{case['lambda']} 1/h"
        text = alone("k_out_of_n", case["t"], k=case["min_sat"], rate=rate_, max=case["max_sat"])
        result = at_start(sound(text), m_available=case["satellites"])
        if "correct_P_fail" in case:
            check(result, case)
        else:
            assert result.unknown == ("m_available",)


def test_the_paper_of_2019() -> None:
    working = {f"m_motor_{i}": True for i in range(6)}
    for case in oracle()["motor_paper_table1"]:
        text = alone("propulsion", case["t"], configuration="PNPNPN", rate="0.04 1/h")
        reliability = at_start(sound(text), **working).reliability
        assert reliability == pytest.approx(case["R"], rel=1e-12, abs=0.0)
        assert reliability == pytest.approx(case["R_paper"], abs=1e-6)
    for case in oracle()["motor_paper_table2"]:
        failed = {"6M": (), "5M": (0,), "4M": (0, 2), "3M": (0, 2, 4)}[case["state"]]
        if case["configuration"] == "PPNNPN":
            failed = {"6M": (), "4M": (0, 2)}[case["state"]]
        text = alone("propulsion", configuration=case["configuration"], rate="0.04 1/h")
        status = {f"m_motor_{i}": i not in failed for i in range(6)}
        assert at_start(sound(text), **status).mttf == pytest.approx(case["MTTF"], rel=1e-12)
        assert case["MTTF"] == pytest.approx(case["MTTF_paper"], abs=0.005)


def as_yaml(tree: Any, events: dict[str, str]) -> str:
    gates: list[str] = []

    def add(node: Any) -> str:
        if isinstance(node, str):
            return node
        kind = next(key for key in node if key != "k")
        below = node[kind] if isinstance(node[kind], list) else [node[kind]]
        names = ", ".join(add(one) for one in below)
        k = f", k: {node['k']}" if "k" in node else ""
        gates.append(f"g{len(gates)}: {{type: {kind}, of: [{names}]{k}}}")
        return f"g{len(gates) - 1}"

    top = add(tree)
    shown = ", ".join(f"{name}: {text}" for name, text in events.items())
    return (
        f"models: {{t: {{type: fault_tree, top: {top}, gates: {{{', '.join(gates)}}}, "
        f"events: {{{shown}}}}}}}\n"
    )


def names(tree: Any) -> set[str]:
    if isinstance(tree, str):
        return {tree}
    below = [one for key, value in tree.items() if key != "k" for one in _list(value)]
    return set().union(*(names(one) for one in below))


def _list(value: Any) -> list[Any]:
    return value if isinstance(value, list) else [value]


def test_fault_trees() -> None:
    for case in oracle()["fault_trees"]:
        events = {
            name: f"{{p: {case['p'].get(name, 0.0)!r}, observed: {name in case['unknown']}}}"
            for name in sorted(names(case["tree"]))
        }
        model = sound(as_yaml(case["tree"], events))
        result = at_start(model, **{f"t_{one}": None for one in case["unknown"]})
        assert result.p_fail_low == pytest.approx(case["p_fail_low"], rel=1e-14, abs=0.0)
        assert result.p_fail_high == pytest.approx(case["p_fail_high"], rel=1e-14, abs=0.0)
        for one in case.get("minimal_cut_sets", ()):
            assert f"- {', '.join(sorted(one))}" in model.readme()


def test_dynamic_gates() -> None:
    for case in oracle()["dynamic_gates"]:
        events = {f"e{i}": f"{{rate: {r!r} 1/h}}" for i, r in enumerate(case["rates"])}
        text = f"horizon: {case['t']} h\n" + as_yaml({case["gate"]: list(events)}, events)
        assert at_start(sound(text)).p_fail == pytest.approx(case["p_fail"], rel=1e-11, abs=0.0)


def test_units() -> None:
    for case in oracle()["units"]:
        found = rate(case["text"])
        assert found.value == pytest.approx(case["per_hour"], rel=1e-15, abs=0.0)
        assert found.has_unit == ("warning" not in case)


def test_evidence() -> None:
    for case in oracle()["evidence"]:
        hold = round(case["hold_s"] * 1e9)
        one = Evidence(Threshold(case["name"], case["activate"], case["release"], hold))
        for seconds, p_fail, valid, expected in case["steps"]:
            assert one.step(round(seconds * 1e9), float(p_fail), usable=valid) == expected, seconds


def test_the_example_of_the_metamodel() -> None:
    path = data_file("monitors/eddi_reliability_example.xml")
    models, problems = models_of(path)
    warned = [one.message.split("'")[1] for one in problems if one.code == "R004"]
    for case in oracle()["ode_models"]:
        assert warned == case["no_unit_warnings"]
        for name in ("Propulsion", "MissionLoss"):
            options = Options(values={"horizon": f"{case['t']} h"})
            model, _ = ReliabilityModel.configure(models[name], options)
            assert model is not None
            result = at_start(model)
            assert result.p_fail == pytest.approx(case[name]["p_fail"], rel=1e-12, abs=0.0)
            if "MTTF" in case[name]:
                assert result.mttf == pytest.approx(case[name]["MTTF"], rel=1e-12)


def test_the_combination_of_motors_battery_and_processor() -> None:
    (case,) = oracle()["combined"]
    model = sound(
        "horizon: 100 h\nmodels:\n"
        "  m: {type: propulsion, configuration: PNPNPN, rate: 1e-3 1/h}\n"
        "  b: {type: battery, failure_rate: 1e-3 1/h, alpha: 8e-3 1/h, beta: 7e-3 1/h, "
        "degradation: 6.4e-3 1/h}\n"
        "  c: {type: processor, mttf_ref: 400 h, t_ref: 30 degC, t_max: 90 degC, u_max: 2}\n"
    )
    motors = {f"m_motor_{i}": True for i in range(6)}
    result = at_start(model, b_level=80.0, c_temperature=50.0, c_utilisation=1.0, **motors)
    assert result.p_fail == pytest.approx(case["correct_P_fail"], rel=1e-12, abs=0.0)


def test_storm() -> None:
    hexa, tree = oracle()["storm"]
    text = alone("propulsion", 100, configuration="PNPNPN", rate="1e-3 1/h")
    result = at_start(sound(text), **{f"m_motor_{i}": True for i in range(6)})
    assert result.p_fail == pytest.approx(hexa["P(F<=100)"], rel=1e-12)
    assert result.mttf == pytest.approx(hexa["MTTF"], rel=1e-9)
    rates = {"A": 0.001, "B": 0.002, "C": 0.003, "D": 0.004, "E": 0.0001}
    shape = {"OR": [{"AND": ["A", "B"]}, {"VOTE": ["A", "C", "D"], "k": 2}, "E"]}
    events = {name: f"{{rate: {r} 1/h}}" for name, r in rates.items()}
    model = sound("horizon: 100 h\n" + as_yaml(shape, events))
    assert at_start(model).p_fail == pytest.approx(tree["P(F<=100)"], rel=1e-12)
    for one in tree["minimal_cut_sets"]:
        assert f"- {', '.join(sorted(one))}" in model.readme()
