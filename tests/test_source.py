from __future__ import annotations

from pathlib import Path

import pytest

from eddi_scaffold.common.files import Source, read_source
from eddi_scaffold.common.problems import EddiError
from eddi_scaffold.monitors.loading import read_models


@pytest.mark.parametrize("name", ["missing", "."])
def test_what_cannot_be_read(tmp_path: Path, name: str) -> None:
    with pytest.raises(EddiError, match="cannot read the file"):
        read_source(tmp_path / name)


@pytest.mark.parametrize(
    ("data", "case"), [(b" \n", "empty"), (b"\x00\x01", "binary"), (b"\x89PNG", "binary")]
)
def test_a_file_without_a_model(data: bytes, case: str) -> None:
    (problem,) = read_models(Source("m.bin", data)).problems
    assert problem.case == f"F003.{case}"


def test_too_large(tmp_path: Path) -> None:
    path = tmp_path / "m"
    path.write_bytes(b"1234")
    with pytest.raises(EddiError, match="more than the limit of 3"):
        read_source(path, limit=3)
    assert read_source(path) == Source(str(path), b"1234")


def test_text_that_is_none_has_the_place_of_its_first_wrong_byte() -> None:
    assert Source("f", "\ufeffü".encode()).text("E001") == "ü"
    with pytest.raises(EddiError) as failure:
        Source("f", "a\nüb\xff".encode("latin-1").replace(b"\xfc", "ü".encode())).text("E001")
    (problem,) = failure.value.problems
    assert (problem.code, problem.place.line, problem.place.col) == ("E001", 2, 3)
