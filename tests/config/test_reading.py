"""eddi_config.yml: what its values mean. What is wrong with one: tests/cli/diagnostics."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from eddi_scaffold.common.files import Source
from eddi_scaffold.config.file import ConfigFile, from_data
from eddi_scaffold.config.schema import Config
from eddi_scaffold.monitors.config_reading import read_config
from eddi_scaffold.yaml_text.writer import dump_plain


def read(text: str) -> ConfigFile:
    config, problems = read_config(Source("c.yml", text.encode()))
    assert config is not None, problems
    return config


def codes(text: str) -> list[str]:
    return [p.code for p in read_config(Source("c.yml", text.encode()))[1]]


def test_no_lease_is_longer_than_words_are_remembered() -> None:
    head = "Model: {id: A, type: ConSert}\n"
    assert codes(f"{head}Fleet: {{robot: b, lease: 60}}\n") == []
    assert codes(f"{head}Fleet: {{robot: b, lease: 60.5}}\n") == ["K003"]


@pytest.mark.parametrize("topic", ["", "/", "a/", "//a", "1a", "a b", "ä", "a\n", "/_a", "a-b"])
def test_what_is_no_topic(topic: str) -> None:
    text = dump_plain(
        {"Model": {"id": "A", "type": "C"}, "EDDIOutputs": [{"id": "o", "topic": topic}]}
    )
    assert codes(text) == ["K003"]


def test_ids_that_look_like_numbers_are_texts() -> None:
    text = "Model: {id: 7, type: C}\nEDDIInputs: [{id: 1, requires: [2]}]\n"
    text += "SimulatorOutputs: [{id: 2, type: a/B, topic: /a}]\n"
    config = read(text).config
    entry = config.EDDIInputs[0]
    assert (config.Model.id, entry.id, entry.requires) == ("7", "1", ["2"])


IDS = st.text(min_size=1, max_size=6).filter(lambda text: text.isprintable())


@given(
    ids=st.lists(IDS, min_size=1, max_size=4, unique=True),
    frequency=st.floats(0.001, 1e6),
    default=st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(),
    age=st.sampled_from(["none", None, 0.1, 5]),
)
def test_what_the_answers_remember_is_what_was_read(
    ids: list[str], frequency: float, default: object, age: object
) -> None:
    data = {
        "Model": {"id": ids[0], "type": "ConSert", "frequency": frequency},
        "EDDIInputs": [{"id": name, "default": default, "max_age": age} for name in ids],
    }
    file = read(dump_plain(data))
    assert from_data(file.as_data(), "remembered").config == file.config
    assert isinstance(file.config, Config)


@pytest.mark.parametrize(
    "data", [3, "x", [], {}, {"Model": {"id": "A", "type": "C"}, "event_files": [1]}]
)
def test_a_damaged_memory_is_a_value_error(data: object) -> None:
    with pytest.raises(ValueError, match=r"."):
        from_data(data, "what the package remembers")
