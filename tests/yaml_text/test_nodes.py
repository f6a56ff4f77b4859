"""YAML nodes: positions, what a plain scalar means in 1.2 and 1.1, limits, and writing."""

import math

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from eddi_scaffold.common.files import Source
from eddi_scaffold.yaml_text import nodes as y


def read(text, code="K001"):
    data = text if isinstance(text, bytes) else text.encode()
    return y.read_document(Source("f.yml", data), code)


def plain(text):
    node, problems = read(f"[ {text} ]" if text else "[ '', ]")
    assert problems == []
    return node.items[0]


@pytest.mark.parametrize(
    "text",
    [
        *("0x" + "f" * 20_000, "0b" + "1" * 20_000, "0" + "7" * 20_000, "9" * 20_000),
        *("1" + ":59" * 20_000, "1" + ":59" * 20_000 + ".5", "1." + "9" * 20_000),
    ],
    ids=["hex", "binary", "octal", "decimal", "sexagesimal", "sexagesimal float", "float"],
)
def test_a_number_of_thousands_of_digits_is_a_text(text):
    assert y.value_11(plain(text)) == text
    assert y.as_number(plain(text)) is None


def test_every_key_and_value_has_its_place():
    node, problems = read("a: 1\nb:\n  - x\n  - {c: 'd'}\n")
    assert problems == []
    assert node.keys() == ["a", "b"]
    (_, first), (key_b, items) = node.entries
    assert (first.place.file, first.place.line, first.place.col) == ("f.yml", 1, 4)
    assert (key_b.place.line, items.place.line, items.place.col) == (2, 3, 3)
    entry = items.items[1].entries[0]
    assert (entry[0].place.col, entry[1].place.col, entry[1].plain) == (6, 9, False)
    assert node.get("b") is items
    assert node.get("z") is None


def test_columns_count_characters_and_a_byte_order_mark_counts_nothing():
    node, _ = read("\ufeff\u00fc: \u00e4\n".encode())
    key, value = node.entries[0]
    assert (key.place.col, value.place.col) == (1, 4)


@pytest.mark.parametrize(
    ("text", "text_12", "number", "value_11"),
    [
        ("on", "on", None, True),
        ("No", "No", None, False),
        ("1:30", "1:30", None, 90),
        ("0x10", "0x10", 16.0, 16),
        ("2022-09-20", "2022-09-20", None, "2022-09-20"),
        ("1.50", "1.50", 1.5, 1.5),
        ("1e3", "1e3", 1000.0, "1e3"),
        ("-.5", "-.5", -0.5, "-.5"),
        ("0o7", "0o7", 7.0, "0o7"),
        ("1_000", "1_000", None, 1000),
        ("07", "07", None, 7),
        ("+5", "+5", 5.0, 5),
        (".inf", ".inf", math.inf, math.inf),
        ("-.INF", "-.INF", -math.inf, -math.inf),
        ("null", None, None, None),
        ("~", None, None, None),
        ("=", "=", None, "="),
        ("<<", "<<", None, "<<"),
        ("1e999", "1e999", None, "1e999"),
        ("1e-999", "1e-999", None, "1e-999"),
        ("0e-999", "0e-999", 0.0, "0e-999"),
        ("0b_", "0b_", None, "0b_"),
    ],
)
def test_what_a_plain_scalar_means(text, text_12, number, value_11):
    node = plain(text)
    assert node.plain
    assert y.as_text(node) == text_12
    result = y.as_number(node)
    assert (None if result is None else result.value) == number
    assert y.value_11(node) == value_11
    assert type(y.value_11(node)) is type(value_11)


@pytest.mark.parametrize("text", ["'on'", '"1"', "!!str 5", "''", "'null'"])
def test_quoted_scalars_are_text(text):
    node = plain(text)
    assert not node.plain
    assert y.as_number(node) is None
    assert y.as_bool(node) is None
    assert y.as_integer(node) is None
    assert not y.is_null(node)
    assert isinstance(y.value_11(node), str)


def test_integers_and_booleans():
    assert y.as_integer(plain("-12")) == -12
    assert [y.as_integer(plain(text)) for text in ("1.0", "0x1", "9" * 30)] == [None] * 3
    assert [y.as_bool(plain(text)) for text in ("true", "FALSE", "yes")] == [True, False, None]


BAD = {
    "": (1, 1, "the file contains no document"),
    "# only a remark\n": (1, 1, "the file contains no document"),
    "a: 1\n---\nb: 1\n": (2, 1, "the file contains more than one document"),
    "a: b: c": (1, 5, "this is not YAML: mapping values are not allowed in this context"),
    "a: *b": (1, 4, "no node before has the anchor of *b"),
    "a: &b [*b]": (1, 8, "no node before has the anchor of *b"),
    "a: &b 1\nc: &b [*b]": (2, 8, "no node before has the anchor of *b"),
    "? [a]\n: b": (1, 3, "a key must be text, not a list"),
    "a: !!a/b ''": (1, 4, "the tag 'tag:yaml.org,2002:a/b' is not supported here"),
    "a: \x00": (1, 4, "this is not YAML: the character U+0000 is not allowed"),
    "[" * 1000: (1, 33, "nested deeper than the limit of 32"),
    "[" * 100_000: (1, 1001, "nested deeper than the limit of 32"),  # PyYAML 6.0.4 stops at 1000
    "- " * 100_000: (1, 65, "nested deeper than the limit of 32"),
}


@pytest.mark.parametrize("text", BAD)
def test_what_cannot_be_read(text):
    node, (problem,) = read(text)
    assert node is None
    place = problem.place
    assert (place.line, place.col, problem.message) == BAD[text]
    assert (problem.code, problem.level) == ("K001", "error")


def test_repeated_keys_at_any_level_are_all_reported():
    node, problems = read("a: {b: 1, 'b': 2}\na: 3\n")
    assert [(p.place.line, p.place.col) for p in problems] == [(1, 11), (2, 1)]
    assert y.value_11(node) == {"a": {"b": 1}}


def test_aliases_count_for_the_depth():
    chain = ["a0: &a0 [x]", *(f"a{n}: &a{n} [*a{n - 1}]" for n in range(1, 40))]
    node, (problem,) = read("\n".join(chain))
    assert node is None
    assert problem.message == "nested deeper than the limit of 32"


def test_a_file_beyond_the_limit_is_not_parsed():
    node, (problem,) = read(b"x" * (y.MAX_BYTES + 1))
    assert node is None
    assert problem.message == "the file has 16777217 bytes, more than the limit of 16777216"


@given(
    st.binary(max_size=60) | st.text(max_size=60).map(lambda text: text.encode("utf-8", "replace"))
)
def test_any_bytes_give_a_node_or_a_problem(data):
    node, problems = read(data)
    assert node is not None or problems


@given(st.text(alphabet="[]{}&*a: \n-'\"|>#%!~0.e_,?\t", max_size=40))
def test_yaml_like_text_is_read_as_pyyaml_reads_it(text):
    """Where both understand a text, the values are the same."""
    node, problems = read(text)
    if node is None or problems:
        return
    try:
        expected = yaml.load(text, Loader=yaml.CSafeLoader)
    except (yaml.YAMLError, ValueError, TypeError):
        return
    assert repr(_texts(y.value_11(node))) == repr(_texts(expected))


def _texts(value):
    """Forget what a key was before it became text, and merge keys."""
    if isinstance(value, dict):
        return [_texts(item) for item in value.values()]
    return [_texts(item) for item in value] if isinstance(value, list) else value


RESOLVED = """
    on off yes No y N true null ~ 1 1.5 1e3 0o7 0x1F 1:30 1_000 .inf .nan = << 2022-09-20 12e4567
    - -a a- ? : # & * ! | > % @ ` a:b a#b /rte/e0 {a} [a] --- ... e3 a,b
"""
SPACED = ["", " ", " a", "a ", "a: b", "a #b", "a\nb", "\x85", "\u2028", "\ufeff", "\U0001f916"]
TRICKY = [*RESOLVED.split(), *SPACED]
texts = st.sampled_from(TRICKY) | st.text(st.characters(exclude_categories=("Cs",)), max_size=12)
numbers = st.integers() | st.floats(allow_nan=False) | st.booleans() | st.none()
data = st.recursive(
    numbers | texts,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(texts, inner, max_size=4),
    max_leaves=12,
)


@given(data)
def test_written_data_are_read_back_by_every_loader(value):
    text = y.dump_plain(value)
    for loader in (yaml.CSafeLoader, yaml.SafeLoader):
        assert repr(yaml.load(text, Loader=loader)) == repr(value)
    if isinstance(value, (dict, list)) and "." * 33 not in repr(value):
        node, problems = read(text)
        assert problems == []
        assert repr(y.value_11(node)) == repr(value)


@pytest.mark.parametrize("text", TRICKY)
def test_written_texts_are_texts_in_both_versions(text):
    node = plain(y.quoted(text))
    assert node.text == text
    assert y.as_text(node) == text
    assert y.value_11(node) == text
    assert y.as_number(node) is None
    assert y.as_bool(node) is None
