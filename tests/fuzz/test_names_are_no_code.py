"""Text of a model or configuration never becomes code, whatever it says.

Packages are generated from arbitrary texts. Each must have the syntax tree of a package that was
generated from plain words, when string constants and identifiers are left out of the comparison.
"""

import ast
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree as ET
from xml.sax.saxutils import quoteattr

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from markdown_it import MarkdownIt

from eddi_scaffold.common.problems import EddiError
from eddi_scaffold.packages.assembly import assemble, monitors_of
from eddi_scaffold.packages.generation import write_packages
from eddi_scaffold.platforms import platforms
from eddi_scaffold.yaml_text.writer import quoted
from tests.cli.command import XML_HEAD, XML_TAIL, template
from tests.data_files import data_text
from tests.hostile_texts import HOSTILE

if sys.version_info >= (3, 11):
    import tomllib

pytestmark = pytest.mark.slow

FEW = max(8, settings.default.max_examples // 25)
WORDS = ["model", "first", "second", "text", "mm", "category", "topic", "source", "file"]
TEXT = st.one_of(
    st.sampled_from(HOSTILE),
    st.text(max_size=12),
    st.builds("{}{}".format, st.sampled_from(HOSTILE), st.text(max_size=4)),
)


def some(size: int) -> st.SearchStrategy[list[str]]:
    """Return plain words, up to three of them replaced by texts that want to be code."""
    places = st.sampled_from([place for place in range(size) if WORDS[place] != "mm"])
    replaced = st.dictionaries(places, TEXT.filter(bool), min_size=1, max_size=3)
    return replaced.map(lambda new: [new.get(n, word) for n, word in enumerate(WORDS[:size])])


def filled(template: str, texts: list[str]) -> str:
    """Return a model or a configuration with these texts, each of them quoted."""
    parts = dict(zip(("model", "first", "second", "text", "unit"), texts, strict=False))
    category, parts["topic"], source, _ = texts[5:]
    parts |= {"kind": category[:40], "safe": category or "Safe"}  # a longer one is not written out
    parts |= {"source": source, "source2": f"{source}2", "field": f"items[k{category}].data"}
    return re.sub("⟦(.*?)⟧", lambda part: quoted(parts[part[1]]), data_text(f"fuzz/{template}"))


def packages(
    folder: Path, platform: str, model: str, config: str | None
) -> dict[str, bytes] | None:
    """Generate a monitor package in memory; ``None`` when the texts were refused."""
    configs = [folder / config] if config else []
    try:
        monitors, problems = monitors_of(folder / model, configs)
        assembly = assemble(monitors, platforms()[platform], folder / "out", problems)
    except EddiError:
        return None
    try:
        outcome = write_packages(folder / "out", assembly.packages[:1], template(), dry_run=True)
    except EddiError as refused:
        if "Manual edit" in str(assembly.packages[0].answers["inputs"]):
            return None  # an id that looks like one of our markers
        raise AssertionError(f"accepted, but not generated: {refused}") from refused
    return {path: state for path, state in outcome.changes.items() if state is not None}


def shapes(files: dict[str, bytes]) -> dict[str, str]:
    """Return the syntax trees of the Python files of our own, without names and texts."""
    return {
        path.rpartition("/")[2]: shape(data)
        for path, data in files.items()
        if path.endswith(".py") and not {".eddi", "eddi_runtime"} & set(Path(path).parts)
    }


def shape(data: bytes) -> str:
    code = data.decode("utf-8")
    compile(code, "generated.py", "exec")
    assert code.isascii() or all(char.isprintable() or char == "\n" for char in code)
    tree = ast.parse(code)
    for node in ast.walk(tree):
        for field in ("id", "attr", "arg", "name", "module"):
            if isinstance(getattr(node, field, None), str):
                setattr(node, field, "x")
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            node.value = "text"
    return ast.dump(tree)


def check(folder: Path, files: dict[str, bytes], sound: dict[str, bytes]) -> None:
    assert shapes(files) == shapes(sound)
    check_texts(files)
    assert not (folder / "out").exists()


README_MARKER = re.compile(
    r"^<!-- Manual edit (begin|end) \| region: readme\.own[ \w:]*-->$", re.MULTILINE
)


def check_texts(files: dict[str, bytes]) -> None:
    """Every other language takes its files, and Markdown shows nothing but text."""
    for path, data in files.items():
        if path.endswith((".xml", ".launch", ".test")):
            ET.fromstring(data)
        if path.endswith(".toml") and sys.version_info >= (3, 11):
            tomllib.loads(data.decode())
        if path.endswith("README.md"):
            assert not {"html_block", "html_inline", "link_open", "image"} & set(shown(data))
        assert ".." not in Path(path).parts


def shown(markdown: bytes) -> Iterator[str]:
    """Yield what Markdown makes of a text: types of blocks, and of what is in a line.

    Not of the markers of the region at its end, which are comments of ours.
    """
    text = README_MARKER.sub("", markdown.decode())
    for token in MarkdownIt("commonmark").enable("table").parse(text):
        yield token.type
        yield from (child.type for child in token.children or ())


@pytest.mark.parametrize("platform", ["plain", "ros1"])
@settings(max_examples=FEW)
@given(texts=some(9))
@example(texts=["a.b", "a'b", 'c"d', "-->", "mm", "{{ x }}", "t\nimport os", "a-b", "file"])
@example(texts=[*WORDS[:5], "\x80", *WORDS[6:9]])
def test_yaml_and_configuration(
    tmp_path_factory: pytest.TempPathFactory, platform: str, texts: list[str]
) -> None:
    folder = tmp_path_factory.mktemp("names")
    files = from_yaml(folder, platform, texts)
    if files is not None:
        check(folder, files, sound_from_yaml(folder, platform))


def from_yaml(folder: Path, platform: str, texts: list[str]) -> dict[str, bytes] | None:
    (folder / "model.yml").write_text(filled("names.yml", texts), "utf-8")
    (folder / "config.yml").write_text(filled("names_config.yml", texts), "utf-8")
    return packages(folder, platform, "model.yml", "config.yml")


SOUND: dict[str, dict[str, bytes]] = {}


def sound_from_yaml(folder: Path, platform: str) -> dict[str, bytes]:
    if platform not in SOUND:
        SOUND[platform] = from_yaml(folder, platform, WORDS) or {}
        assert SOUND[platform]
    return SOUND[platform]


@settings(max_examples=FEW)
@given(texts=some(3))
@example(texts=["'''\nimport os\n'''", 'a"b', "import"])
def test_xml(tmp_path_factory: pytest.TempPathFactory, texts: list[str]) -> None:
    folder = tmp_path_factory.mktemp("names")
    files = from_xml(folder, texts)
    if "xml" not in SOUND:
        SOUND["xml"] = from_xml(folder, WORDS) or {}
        assert SOUND["xml"]
    if files is not None:
        check(folder, files, SOUND["xml"])


DIMENSION = (
    '<dependabilityProperty><dimension xsi:type="consert_:BinaryDimension">'
    '<dimensionType name="IsTrue"/></dimension></dependabilityProperty>'
)


def from_xml(folder: Path, texts: list[str]) -> dict[str, bytes] | None:
    name, evidence, text = (quoteattr(value.replace("\n", " ")) for value in texts[:3])
    inner = (
        f"<conSerts name={name} description={text}>"
        '<guaranteePropagation source="//@odeProductPackages.0/@conSerts.0/@runtimeEvidence.0"'
        ' target="//@odeProductPackages.0/@conSerts.0/@guarantees.0"/>'
        f'<guarantees name="G" description={text}>{DIMENSION}</guarantees>'
        f"<runtimeEvidence name={evidence} description={text}>{DIMENSION}</runtimeEvidence>"
        "</conSerts>"
    )
    data = f"{XML_HEAD}{inner}{XML_TAIL}".encode("utf-8", "surrogatepass")
    (folder / "model.xml").write_bytes(data)
    return packages(folder, "plain", "model.xml", None)
