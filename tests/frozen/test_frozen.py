"""What later work must not change: compiled monitors, and the JSON of the commands.

`tests/frozen/digests.json` has a digest of each text. A test that fails names the texts and writes
them to a folder; see `Frozen.compare` for how to find the difference.
"""

from __future__ import annotations

import hashlib
import json
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from zlib import crc32

import pytest
from hypothesis import settings

from tests.cli.command import ROOT
from tests.data_files import write_files
from tests.frozen import corpus
from tests.frozen.texts import Parts, compiled, names_of_models, parts_of, printed

pytestmark = pytest.mark.slow

DIGESTS = Path(__file__).parent / "digests.json"
EACH, ALL = 8, 200
"""Random models of a kind in a usual run, and in the long profile."""
HELP = """\
For those from before run `pytest tests/frozen --frozen-texts FOLDER` in a checkout of the last
commit that changed `digests.json`, and compare the folders. Only where the change is meant:
`pytest tests/frozen --update-frozen`."""
PACKAGES = ["examples/*/expected/*/", "examples/*/expected/src/eddi_monitor/*/"]


@dataclass(frozen=True)
class Frozen:
    """The digests, and where texts are written."""

    update: bool
    texts: Path | None
    folder: Path

    def compare(self, group: str, texts: Mapping[str, Parts], *, whole: bool = True) -> None:
        """Compare texts with their digests.

        Models that are not in the file yet may come; none that is in it may be refused."""
        got = {name: {part: _digest(one) for part, one in it.items()} for name, it in texts.items()}
        got = {name: parts for name, parts in got.items() if parts}
        known = json.loads(DIGESTS.read_text()) if DIGESTS.exists() else {}
        if self.update:
            known = {k: it for k, it in known.items() if not k.startswith(f"{group}/")} | got
            rows = (f"{json.dumps(k)}: {json.dumps(it)}" for k, it in sorted(known.items()))
            DIGESTS.write_text("{\n" + ",\n".join(rows) + "\n}\n")
        expected = {name: it for name, it in known.items() if name.startswith(f"{group}/")}
        absent = expected.keys() - got.keys() if whole else ()
        differ = [f"{name}: refused, or no longer there" for name in sorted(absent)]
        place = self.texts or self.folder / "differ"
        for name, parts in texts.items():
            for part, text in parts.items():
                is_as_before = expected.get(name, got.get(name, {})).get(part) == got[name][part]
                differ += [] if is_as_before else [f"{name}.{part}"]
                if self.texts or not is_as_before:
                    write_files(place, {f"{name}.{part}": text})
        assert not differ, "\n  ".join(
            [
                f"{len(differ)} of {len(expected)} texts are not those of {DIGESTS.name}:",
                *differ,
                f"They are below {place}. {HELP}",
            ]
        )


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:16]


@pytest.fixture(autouse=True)
def no_pgmpy(monkeypatch: pytest.MonkeyPatch) -> None:
    """Leave out the comparison with pgmpy: it takes long, and changes no text."""
    monkeypatch.setitem(sys.modules, "pgmpy", None)


@pytest.fixture
def frozen(request: pytest.FixtureRequest, tmp_path: Path) -> Frozen:
    texts = request.config.getoption("--frozen-texts")
    place = Path(texts).absolute() if texts else None
    return Frozen(request.config.getoption("--update-frozen"), place, tmp_path)


def folders(name: str, tmp_path: Path) -> Iterator[tuple[str, Path]]:
    """Write the cases of a name; yield their names and folders."""
    for case, files in corpus.cases(name):
        yield case, write_files(tmp_path / "files" / case, files)


def connected(case: str, folder: Path, platforms: Sequence[str]) -> Iterator[tuple[str, Parts]]:
    """Yield what is compiled for each configuration of a folder: its words, and the text.

    A configuration that names no model gets one of the folder that fits.
    """
    for config in corpus.configurations(folder):
        words = ("-c", config, *corpus.ROBOTS.get(case, ()), "--platform")
        for model in ((), *(("-m", file) for file in corpus.models(folder)[::-1])):
            texts = {}
            for platform in platforms:
                if not (text := compiled(folder, *model, *words, platform)):
                    break
                texts[" ".join((*model, *words, platform))] = text
            yield from texts.items()
            if texts:
                break


@pytest.mark.parametrize("name", corpus.folders())
def test_compiled_text_of(name: str, frozen: Frozen, tmp_path: Path) -> None:
    texts: dict[str, Parts] = {}
    for case, folder in folders(name, tmp_path):
        platforms = ("plain", "ros1")
        if not name.startswith("examples"):  # the body is the same on each
            platforms = platforms[crc32(case.encode()) % 2 :][:1]
        for words, text in connected(case, folder, platforms):
            texts[f"compiled/{case}/{words}"] = text
        files = corpus.models(folder) if name != "oracles/deployments" else ()
        for file in files:
            for model in names_of_models(folder, file):
                words = ("-m", file, "--name", model, "--platform", "plain")
                texts[f"compiled/{case}/{' '.join(words)}"] = compiled(folder, *words)
    frozen.compare(f"compiled/{name}", texts)


@pytest.mark.parametrize("kind", corpus.MAKERS)
def test_compiled_text_of_random(kind: str, frozen: Frozen, tmp_path: Path) -> None:
    count = ALL if frozen.update or settings().max_examples > 1000 else EACH
    texts: dict[str, Parts] = {}
    for number, (case, files) in enumerate(corpus.random_cases(kind, count)):
        folder = write_files(tmp_path / "files" / case, files)
        configs = corpus.configurations(folder)
        given = ("-c", *configs) if configs else ("-m", *corpus.models(folder))
        name = (
            ("--name", {"consert": "Cell", "reliability": "Tree"}[kind])
            if "eddi.xml" in files
            else ()
        )
        platform = "ros1" if configs and number % 4 else "plain"
        texts[f"compiled/{case}"] = compiled(folder, "--platform", platform, *given, *name)
    assert sum(map(bool, texts.values())) > 0.8 * count, texts.keys()
    frozen.compare(f"compiled/random/{kind}", texts, whole=count == ALL)


@pytest.mark.parametrize(
    "example",
    ["drone", "motor-watch", "pedestrian", "safeml", "shuttle", "two-conserts"],
)
def test_texts_are_those_of_packages(example: str, tmp_path: Path) -> None:
    ((case, folder),) = folders(f"examples/{example}", tmp_path)
    is_ros = example == "two-conserts"
    texts = [text for _, text in connected(case, folder, ["ros1" if is_ros else "plain"])]
    packages = sorted((ROOT / "examples" / example / "expected").rglob("compiled.py"))
    assert packages
    for file in packages:
        first, _, rest = file.read_text("utf-8").partition("\n")
        assert first == "# fmt: off"
        assert parts_of(rest) in texts


@pytest.mark.parametrize("name", corpus.folders())
def test_json_of_check_and_show(name: str, frozen: Frozen, tmp_path: Path) -> None:
    commands = []
    for case, folder in folders(name, tmp_path):
        models, configs = corpus.models(folder), corpus.configurations(folder)
        deployments = [one.name for one in sorted(folder.glob("*deployment.yml"))]
        robot = corpus.ROBOTS.get(case, ())[2:]
        words = [("check", *models, *configs, *robot)] if configs else []
        if name != "oracles/deployments":
            words += [("check", file) for file in (*models, *deployments)]
            words += [("show", file) for file in (*models, *configs)]
        commands += [(case, folder, one) for one in words]
    for command in ("check", "show"):
        texts = {
            f"{command}/{case}/{' '.join(words[1:])}": printed(folder, *words)
            for case, folder, words in commands
            if words[0] == command
        }
        frozen.compare(f"{command}/{name}", texts)


@pytest.mark.parametrize("name", corpus.RUNS)
def test_json_of_run(name: str, frozen: Frozen, tmp_path: Path) -> None:
    ((_, folder),) = folders(name, tmp_path)
    texts = {
        f"run/{name}/{number} {words}": printed(folder, "run", *words.split())
        for number, words in enumerate(corpus.RUNS[name])
    }
    frozen.compare(f"run/{name}", texts)


@pytest.mark.parametrize("command", ["trace", "status"])
def test_json_of_packages(command: str, frozen: Frozen) -> None:
    texts = {}
    for folder in sorted(path for pattern in PACKAGES for path in ROOT.glob(pattern)):
        if (folder / ".copier-answers.yml").exists() and folder.name != "eddi_runtime":
            name = folder.relative_to(ROOT / "examples")
            texts[f"{command}/{name}"] = printed(folder.parent, command, folder.name)
    frozen.compare(command, texts)
