"""Reading, names and checks agree with the shared oracle."""

from eddi_scaffold.kinds.consert import names
from eddi_scaffold.kinds.consert.compose import compose
from eddi_scaffold.kinds.consert.consert_model import ConSertModel
from tests.kinds.consert.example import as_source, oracle

MORE = {
    *("P_uom_percent", "P_uom_rad"),  # units of robots, which conserts-rs does not have
    *("P_guar_dimensions_empty", "P_cat_no_subset", "P_num_no_subset"),  # EDDIs have such
}

LEVELS = ("error", "warning", "info")


def test_parse_gives_the_wanted_severity_and_code():
    wrong = []
    for case in oracle()["parse"]:
        problems = ConSertModel.read_file(as_source(case.get("doc", case.get("text"))), ()).problems
        want, codes = case["want"], {problem.code for problem in problems}
        if case["id"] in MORE:
            want = {"result": "ok"}
        if want.get("code") == "C002":  # stricter than the oracle: a lost key may be a lost unit
            want = {**want, "result": "error"}
        result = min((problem.level for problem in problems), default="ok", key=LEVELS.index)
        if result != want["result"] or ("code" in want and want["code"] not in codes):
            wrong.append((case["id"], want, result, sorted(codes)))
    assert wrong == []


def test_names_agree():
    wrong = []
    for case in oracle()["names"]:
        id_ = case["id"]
        if names.class_name(id_) != case["class"]:
            wrong.append((id_, names.class_name(id_)))
    assert wrong == []


def test_every_model_is_read_with_the_listed_errors_only():
    wanted = oracle()["model_errors"]
    for name, document in oracle()["models"].items():
        reading = ConSertModel.read_file(as_source(document, f"{name}.yml"), ())
        errors = {problem.code for problem in reading.problems if problem.level == "error"}
        assert errors == set(wanted.get(name, ())), name
        assert [model.name for model in reading.models] == [name]


def test_composition_agrees():
    wrong = []
    for case in oracle()["compose"]:
        instances, codes = [], set()
        for number, document in enumerate(case["models"]):
            content = oracle()["models"][document] if isinstance(document, str) else document
            reading = ConSertModel.read_file(as_source(content, f"m{number}.yml"), ())
            codes |= {problem.code for problem in reading.problems}
            instances += [(model.name, model.data) for model in reading.models]
        result, want = compose(instances), case["want"]
        same = result.composable == want["composable"] and (
            "code" not in want or want["code"] in codes
        )
        for key in ("unmatched_demands", "unmatched_services"):
            same = same and list(getattr(result, key)) == want.get(key, [])
        if not same or bool(result.reasons) == result.composable:
            wrong.append((case["id"], want, result, sorted(codes)))
    assert wrong == []
