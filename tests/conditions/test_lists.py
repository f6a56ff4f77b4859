"""Reductions of lists: definition = in this process = generated Python; and what they refuse."""

import math
import random
from collections.abc import Mapping
from typing import Any

import pytest

from eddi_scaffold.common.problems import EddiError
from eddi_scaffold.conditions.analysis import analyse
from eddi_scaffold.conditions.definition import aggregated, combined
from eddi_scaffold.conditions.parser import parse
from eddi_scaffold.conditions.standalone import generate
from eddi_scaffold.conditions.syntax import File, SyntaxNode, canonical, is_list_path
from eddi_scaffold.program.running import Engine
from tests.data_files import data_text, tabled

DECLARATIONS = data_text("conditions/lists.events")
SECOND = 10**9


def reference(file: File, root: int, values: Mapping[str, Any]) -> Any:
    """Return the value of a reduction by its definition, None for UNKNOWN."""
    node = file.nodes[root]
    assert node.options is not None
    names = {n.text for n in subtree(file, root) if n.op == "name" and is_list_path(n.text)}
    lists = [values[name] for name in names]
    if any(entry is None for entry in lists) or len({len(entry) for entry in lists}) != 1:
        return None
    count = len(lists[0])
    if node.options.length is not None:
        least, most = node.options.length
        if not least <= count <= most:
            return None
    if count == 0:
        return None
    result = [
        element(file, node.args[0], values, k, limits(file, node, values)) for k in range(count)
    ]
    known = [x for x in result if x is not None]
    if node.op in ("list_any", "list_all") and (node.op == "list_any") in known:
        return node.op == "list_any"
    if len(known) / count < (node.coverage or 1.0):
        return None
    if node.op in ("list_any", "list_all"):
        return node.op == "list_all"
    infinite = any(isinstance(x, float) and math.isinf(x) for x in known)
    if infinite and node.op in ("list_sum", "list_average", "list_stddev"):
        return None
    if infinite and node.op == "list_median":
        ordered = sorted(known)
        low, high = ordered[(len(ordered) - 1) // 2], ordered[len(ordered) // 2]
        if low != high and math.isinf(low + high):
            return None if math.isinf(low) and math.isinf(high) else low + high
        return low if low == high else low / 2 + high / 2
    return aggregated(node.op.removeprefix("list_"), known)


def subtree(file: File, root: int) -> list[SyntaxNode]:
    node = file.nodes[root]
    return [node, *(entry for arg in node.args for entry in subtree(file, arg))]


def limits(file: File, node: SyntaxNode, values: Mapping[str, Any]) -> tuple[Any, Any] | None:
    if not (node.options and node.options.within):
        return None
    low, high = (element(file, arg, values, 0, None) for arg in node.args[1:])
    return low, high


def element(
    file: File, root: int, values: Mapping[str, Any], k: int, within: tuple[Any, Any] | None
) -> Any:
    node = file.nodes[root]
    if node.op == "number":
        return float(node.text)
    if node.op == "name":
        raw = values[node.text][k] if is_list_path(node.text) else values[node.text]
        return valid(node.text, raw, within)
    args = [element(file, arg, values, k, within) for arg in node.args]
    if node.op == "hypot":
        return combined("sqrt", [combined("add", [combined("mul", [x, x]) for x in args])])
    if node.op == "clamp":
        return combined("least", [combined("greatest", args[:2]), args[2]])
    return combined(node.op, args)


def valid(name: str, raw: Any, within: tuple[Any, Any] | None) -> Any:
    if name == "m.b[*]":
        return raw if isinstance(raw, bool) else None
    if not isinstance(raw, float) or math.isnan(raw):
        return None
    if within is not None and is_list_path(name) and None in within:
        return None
    if math.isinf(raw):
        return raw if name == "m.y[*]" else None
    if name == "m.x[*]" and not -50 <= raw <= 50:
        return None
    if within is not None and is_list_path(name):
        return raw if within[0] <= raw <= within[1] else None
    return raw


def formula(rng: random.Random) -> str:
    kind = rng.choice(["number", "number", "bool"])
    coverage = rng.choice(["", "", ", COVERAGE 0.5", ", COVERAGE 0.9"])
    length = rng.choice(["", "", ", LENGTH 4", ", LENGTH 1 .. 5"])
    if kind == "number":
        inner = rng.choice(
            (
                *("m.x[*]", "m.y[*]", "ABS(m.x[*])", "m.x[*] + m.y[*]", "m.y[*] - m.low"),
                *("SQRT(m.x[*])", "LEAST(m.x[*], m.low)", "m.x[*] / m.y[*]", "HYPOT(m.x[*], 3)"),
            )
        )
        within = (
            ", WITHIN m.low .. 5" if inner in ("m.x[*]", "m.y[*]") and rng.random() < 0.4 else ""
        )
        function = rng.choice(["MIN", "MAX", "AVERAGE", "SUM", "MEDIAN", "STDDEV"])
        return f"{function}({inner}{length}{within}{coverage})"
    inner = rng.choice(
        (
            *("m.b[*]", "m.x[*] > 1", "m.x[*] > m.y[*] OR m.b[*]", "NOT m.b[*]", "KNOWN(m.y[*])"),
            *("m.b[*] IMPLIES m.x[*] > m.low", "m.b[*] XOR m.x[*] > 0"),
        )
    )
    return f"{rng.choice(['ANY', 'ALL', 'COUNT'])}({inner}{length}{coverage})"


def sample(rng: random.Random) -> dict[str, Any]:
    count = rng.choice([0, 1, 2, 4, 4, 5, 9])
    trouble = rng.choice([0.0, 0.0, 0.05, 0.4])

    def number(*, infinite: bool) -> Any:
        if rng.random() < trouble:
            return rng.choice([math.nan, None, "3", 1e9, *([math.inf, -math.inf] * infinite)])
        return rng.choice([rng.uniform(-8, 8), float(rng.randint(-3, 3))])

    result: dict[str, Any] = {
        "m.x[*]": [number(infinite=True) for _ in range(count)],
        "m.y[*]": tuple(number(infinite=True) for _ in range(count)),
        "m.b[*]": [rng.choice([True, False] * 5 + [None] * (trouble > 0)) for _ in range(count)],
        "m.low": rng.choice([-1.0, 0.5, None]),
    }
    if rng.random() < 0.05:
        result[rng.choice(list(result))] = None
    return result


def generated(text: str) -> Any:
    ((name, module),) = generate(analyse(text, rate=10), "python", "lists").items()
    names: dict[str, Any] = {"__name__": "lists_event"}
    exec(compile(module, name, "exec", dont_inherit=True), names)
    monitor = names["Monitor"]()
    monitor.module = names
    return monitor


def test_definition_engine_and_module_agree_on_random_lists() -> None:
    compared = 0
    for seed in range(60):
        rng = random.Random(seed)
        text = DECLARATIONS + formula(rng)
        file = parse(text)
        analysis = analyse(text, rate=10)
        assert analysis.program is not None, [p.message for p in analysis.problems]
        engine = Engine(analysis.program)
        sampling = engine.sampling
        monitor = generated(text)
        for t in range(40):
            values = sample(rng)
            used = {entry.name for entry in sampling.inputs}
            lists = {name for name in used if is_list_path(name)}
            if any(values[name] is None for name in lists):
                expected = None
            else:
                expected = reference(file, file.events[0].root, values)
            (result,) = engine.step(t * SECOND, [values[entry.name] for entry in sampling.inputs])
            assert same(result, expected, analysis), (text, values, result, expected)
            for entry in sampling.inputs:
                word = entry.name.replace("[*]", "").replace(".", "_")
                setattr(monitor, f"read_{word}", lambda v=values[entry.name]: v)
            output = monitor.step(t * SECOND)
            truth = output["event"].truth if isinstance(output, dict) else output
            assert truth == result or (math.isnan(truth) and math.isnan(result))
            compared += expected is not None
    assert compared > 500


def same(result: float, expected: Any, analysis: Any) -> bool:
    if analysis.events[0].type == "bool":
        return result == {True: 2, False: 0, None: 1}[expected]
    if expected is None:
        return math.isnan(result)
    return result == expected or math.isclose(result, expected, rel_tol=1e-9, abs_tol=1e-12)


@tabled
def test_the_canonical_form_is_read_again(text: str) -> None:
    file = parse(text)
    assert canonical(file, file.events[0].root) == text


def test_units_go_through_lists_and_functions() -> None:
    declared = "VAR s.r[*] : NUMBER UNIT m VAR c : NUMBER UNIT m "
    for expression, fits in (
        ("MIN(s.r[*]) > 80 cm", True),
        ("MIN(s.r[*], WITHIN 5 cm .. 3 km) > 1 m", True),
        ("MIN(s.r[*]) > 1 s", False),
        ("COUNT(s.r[*] > 1 kg) > 1", False),
        ("HYPOT(c, 30 cm) > 1 m", True),
        ("GREATEST(c, MAX(s.r[*])) > 1 m", True),
    ):
        result = analyse(f"{declared}{expression}", rate=10)
        assert (result.program is not None) is fits, expression
    covariance = "VAR v : NUMBER UNIT m VAR k : NUMBER UNIT m SQRT(v) > 1 m"
    assert [entry.code for entry in analyse(covariance).problems if entry.level == "error"] == [
        "E009"
    ]


def test_c_says_that_it_has_no_lists_yet() -> None:
    with pytest.raises(EddiError) as failure:
        generate(analyse("MIN(scan.ranges[*]) > 1", rate=10), "c", "scan")
    (problem,) = failure.value.problems
    assert (problem.code, problem.message) == (
        "E026",
        "the target c takes neither lists nor texts yet: scan.ranges[*]",
    )
