"""What `export` writes reads back as the same model, by its digest."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from pathlib import Path

import pytest

from eddi_scaffold.common.files import Source, read_source
from eddi_scaffold.common.problems import EddiError
from eddi_scaffold.kinds import Model, kinds
from eddi_scaffold.monitors.compiling import digest_of
from eddi_scaffold.monitors.loading import read_models
from tests.data_files import ORACLES, write_files
from tests.frozen import corpus
from tests.metamodel.eddis import random_eddi

DATA = ORACLES.parent / "reliability"


def reread(model: Model, folder: Path) -> Model:
    files = model.write()
    write_files(folder, files)
    reading = kinds()[model.kind].model_class.read_file(read_source(folder / next(iter(files))), ())
    (again,) = reading.models
    return again.named(model.name)


def check(cases: Iterable[Mapping[str, bytes]], folder: Path) -> Counter[str]:
    """Write and read each model of each case; return how many there are of each kind."""
    counts: Counter[str] = Counter()
    for number, files in enumerate(cases):
        place = write_files(folder / str(number), files)
        models = corpus.models(place) if files else ()
        for path in [*(place / name for name in models), *place.glob("*.xmlbif")]:
            for model in _models(path):
                (place / "written").mkdir(exist_ok=True)
                again = reread(model, place / "written")
                assert digest_of(again.kind, again) == digest_of(model.kind, model), model.name
                counts[model.kind] += 1
    return counts


def _models(path: Path) -> Iterable[Model]:
    try:
        return read_models(read_source(path)).models
    except EddiError:  # a file of another tool
        return ()


@pytest.mark.parametrize("name", corpus.folders())
def test_models_of_the_repository(name: str, tmp_path: Path) -> None:
    check((files for _, files in corpus.cases(name)), tmp_path)


@pytest.mark.parametrize("kind", corpus.MAKERS)
def test_random_models(kind: str, tmp_path: Path) -> None:
    cases = (files for _, files in corpus.random_cases(kind, 12))
    assert sum(check(cases, tmp_path).values()) >= 12


def test_random_eddis(tmp_path: Path) -> None:
    cases = ({"eddi.xml": random_eddi(number).data} for number in range(12))
    assert sum(check(cases, tmp_path).values()) >= 12


def test_models_with_every_key(tmp_path: Path) -> None:
    counts = check(({path.name: path.read_bytes()} for path in DATA.iterdir()), tmp_path)
    assert counts == {"reliability": 4}


NETWORK = """network n {}
variable "two  blanks" { type discrete [ 2 ] { a, b }; }
probability ( "two  blanks" ) { table 0.1, 0.9; }
"""
LANDING = Path(__file__).parents[1] / "eddi_xml" / "models" / "landing.xml"


@pytest.mark.parametrize(
    ("file", "text", "message", "line"),
    [
        ("n.bif", NETWORK, "the blanks of 'two  blanks'", 2),
        ("e.xml", LANDING.read_text("utf-8").replace('"10"', '"50"'), "the frequency 50 of", 10),
    ],
)
def test_what_a_format_cannot_say_is_refused(file: str, text: str, message: str, line: int) -> None:
    model = read_models(Source(file, text.encode())).models[-1]
    with pytest.raises(EddiError) as failure:
        model.write()
    (problem,) = failure.value.problems
    assert (problem.case, problem.place.line) == ("G004.unsaid", line)
    assert message in problem.message
