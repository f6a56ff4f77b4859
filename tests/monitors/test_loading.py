"""Files that hold no model: what is wrong with them is said in a word."""

from pathlib import Path

import pytest

from eddi_scaffold.common.files import read_source
from eddi_scaffold.monitors.loading import read_models


@pytest.mark.parametrize(
    ("name", "data", "said"),
    [
        ("m.xml", b" \n", "this file is empty"),
        ("m.yml", b"", "this file is empty"),
        ("m.bin", b"\x00\x01", "this is not text"),
        ("m.png", b"\x89PNG", "this is not text"),
        ("m.txt", b"hello", "this is neither an EDDI XML file nor a model"),
    ],
)
def test_a_file_without_a_model(tmp_path: Path, name: str, data: bytes, said: str) -> None:
    path = tmp_path / name
    path.write_bytes(data)
    (problem,) = read_models(read_source(path)).problems
    assert (problem.code, problem.message.startswith(said)) == ("F003", True)
