"""Whether the text of a package is the model that its source has: the text is not executed first.

The model is that of its own file, never the copy in the package; the configuration is what the
package remembers, or a file that is given.
"""

from __future__ import annotations

import hashlib
import importlib
import json
import logging
import platform
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import eddi_runtime
from eddi_runtime.history import EDDIInputBase
from eddi_runtime.plain_values import one_line
from eddi_runtime.testing import failures

from eddi_scaffold.common.files import next_to, read_regular, read_source
from eddi_scaffold.common.identifiers import package_name
from eddi_scaffold.common.problems import EddiError, Place, plural, problem
from eddi_scaffold.config.file import from_data, named_model_path
from eddi_scaffold.evidence.conditions import expressions
from eddi_scaffold.evidence.emitted import Emitted, Finding, UnprovedError
from eddi_scaffold.kinds import JsonValue, kinds
from eddi_scaffold.monitors.answers import VECTORS
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.compiling import from_json as facts_of
from eddi_scaffold.monitors.config_reading import read_configs
from eddi_scaffold.monitors.loading import checked_models, model_for, select_models
from eddi_scaffold.packages.rendering import ANSWERS_FILE
from eddi_scaffold.packages.upgrading import PackageGroup, rejoined
from eddi_scaffold.program.monitor_text import Declaration
from eddi_scaffold.program.running import module_of
from eddi_scaffold.regions.check import list_regions
from eddi_scaffold.regions.markers import digest
from eddi_scaffold.regions.package import read_file

_BY_HAND = ("edited", "outside", "rejected", "broken")


@dataclass(frozen=True)
class Verified:
    """What `verify` says of a package."""

    package: str  # its folder
    model: str  # file of the model
    sha256: str  # of that file
    holds: bool  # all is proved, and no test fails
    findings: Sequence[Finding]  # what differs, or is not proved
    # `proved`, `tested`, `not`, `trusted` -> what is so, in a line each
    evidence: Mapping[str, Sequence[str]]

    @property
    def is_tested(self) -> bool:
        """Whether there are vectors, and all pass."""
        return self.holds and bool(self.evidence["tested"])

    def as_json(self) -> dict[str, JsonValue]:
        """Return the JSON form of ``verify --json``."""
        findings: list[JsonValue] = [of._asdict() for of in self.findings]
        evidence = {word: [*lines] for word, lines in self.evidence.items()}
        own = {name: of for name, of in vars(self).items() if name != "evidence"}
        return {**own, "findings": findings, **evidence}

    def as_text(self) -> str:
        """Return a few lines for people."""
        differs = any(of.differs for of in self.findings)
        word = "differs from" if differs else f"{'not ' * bool(self.findings)}proved equal to"
        lines = [f"{self.package}: {word} {self.model} (sha256 {self.sha256[:8]})"]
        for of in self.findings:
            word = "differs   " if of.differs else "not proved:"
            lines.append(f"  {word} compiled.py:{of.line}: {of.text}")
        rows = [f"  {word:8} {line}" for word, of in self.evidence.items() for line in of]
        return "\n".join([*lines, *rows])


def checked(monitor: BoundMonitor, text: str) -> tuple[list[str], list[Finding]]:
    """Compare a text with a model and its configuration: what is proved, and what is not."""
    kind, proved = monitor.model.kind, list[str]()
    declared = Declaration(monitor.model.name, monitor.facts.digest, monitor.bound)
    parts = [importlib.import_module(f"eddi_runtime.{part}") for part in (kind, "expressions")]
    formats = {of.__name__.rpartition(".")[2]: of.FORMAT for of in (eddi_runtime, *parts)}
    findings: list[Finding] = []
    try:
        emitted = Emitted(text, kind, declared, formats)
        findings = emitted.findings
        proved += monitor.model.verify(emitted)
        proved += ["the table of inputs", *expressions(emitted)]
        emitted.end()
    except UnprovedError as refused:
        findings.append(Finding(refused.line, str(refused), differs=False))
    except (ArithmeticError, AttributeError, LookupError, RecursionError, TypeError, ValueError):
        # where a form takes any data, these may be of another type
        findings.append(Finding(1, "it has no known form", differs=False))
    return [] if findings else proved, findings


def verified(
    group: PackageGroup, folder: str, model: Path | None, configs: Sequence[Path]
) -> Verified:
    """Compare the text of a package with its model; run its vectors where it is proved.

    Raises:
        EddiError: the source is not found, or is another one (U005), or it cannot be used.
    """
    package, answers = group.root / folder, group.present[folder]
    facts, text_of = facts_of(answers["facts"]), answers.get("config")
    read, _ = read_configs(configs)
    newer = {package_name(of.config.Model.id): of for of in read}
    path = model or (named_model_path(newer[folder]) if folder in newer else None)
    path = path or _source(package, facts.file, facts.file_sha256)
    if read_source(path).sha256 != facts.file_sha256:
        place, sha256 = Place(str(path)), facts.file_sha256
        raise EddiError(problem("U005.other_source", place, package=folder, sha256=sha256))
    models = checked_models(path, answers.get("default_guarantees") or ()).models
    if folder in newer or text_of:
        source = model_for(newer.get(folder) or from_data(text_of, folder), models)
    else:
        (source, *_) = select_models(models, facts.id, kinds()[facts.kind])
    monitor, _ = rejoined(folder, answers, source, newer.get(folder))
    code = next((name for name in answers["files"] if name.endswith("compiled.py")), "")
    file = next_to(str(package / ANSWERS_FILE), code)
    text = read_regular(file).decode("utf-8", "replace")
    proved, findings = checked(monitor, text)
    # only what is proved is executed
    tested, holds = ([], False) if findings else _tested(monitor, text, package, file.parent)
    trusted = [f"Python {platform.python_version()}", _runtime(), f"reader of {path.name}"]
    trusted += [f"the configuration in {ANSWERS_FILE}"] if text_of and folder not in newer else []
    evidence = {
        "proved": ["; ".join(proved)] if proved else [],
        "tested": tested,
        "not": [*_by_hand(package, code)],
        "trusted": [", ".join(trusted)],
    }
    return Verified(folder, path.name, facts.file_sha256, holds, findings, evidence)


def _source(package: Path, name: str, sha256: str) -> Path:
    """Return the file of a model, from here or from the folders around its package."""
    for folder in (Path(), *package.resolve().parents):
        path = folder / Path(name).name
        if path.is_file() and read_source(path).sha256 == sha256:
            return path
    place = Place(str(package))
    raise EddiError(problem("U005.no_source", place, package=package.name, file=name))


def vectors_in(text: bytes | str) -> int:
    """Return how many vectors there are in the text of a file of them."""
    data = json.loads(text) if text else {}
    return len(data.get("vectors", ())) + len(data.get("runs", ()))


def in_short(monitor: BoundMonitor, files: Mapping[str, bytes]) -> str:
    """Return what is shown of a monitor that was generated."""
    _, findings = checked(monitor, monitor.compiled.text)
    word = f"not proved, {findings[0].text}" if findings else "proved"
    return f"{monitor.package}: {plural(vectors_in(files.get(VECTORS, b'')), 'vector')}; {word}"


def _tested(monitor: BoundMonitor, text: str, package: Path, code: Path) -> tuple[list[str], bool]:
    """Run the vectors of a model with a text: what to say, and whether all pass."""
    about = {"model": monitor.facts.file, "sha256": monitor.facts.file_sha256}
    vectors = monitor.model.vectors(monitor.bound, about).encode()
    file = package / VECTORS
    if vectors and (not file.is_file() or read_regular(file) != vectors):
        return [f"{VECTORS} is not that of the model"], False
    logging.disable()  # what actions report is not of a robot
    try:
        class_ = module_of(text, monitor.model.name, lambda name: read_regular(code / name)).Monitor
        failed = failures(str(file), class_, input_class(class_)) if vectors else []
    except Exception as failure:  # noqa: BLE001 - such as a name that is not imported
        failed = [f"it does not run: {one_line(failure)}"]
    finally:
        logging.disable(logging.NOTSET)
    passed = f"{len(failed)} differences" if failed else "all passed"
    what = f"{plural(vectors_in(vectors), 'vector')}, {passed}"
    return [what, *failed] if vectors or failed else [], not failed


def input_class(of: Any) -> type[Any]:
    """Return the class that reads the messages of a monitor, without what a person writes in it."""
    inputs = of.inputs

    class Input(EDDIInputBase):
        def __init__(self) -> None:
            super().__init__(inputs)
            vars(self).update({spec.attribute: spec.default for spec in inputs})

        def processing(self, messages: Mapping[str, object]) -> None:
            self.begin_processing()
            for spec in inputs:
                take = self.update_each if spec.every_message else self.update
                take = self.update_expression if spec.expression else take
                take(spec.id, getattr(self, f"process_{spec.attribute}"), messages, spec.requires)

    return Input


def _runtime() -> str:
    """Return which runtime executes the text here: its version, and a digest of its files."""
    root = Path(eddi_runtime.__path__[0])
    text = b"".join(path.read_bytes() for path in sorted(root.rglob("*.py")))
    return (
        f"eddi_runtime {eddi_runtime.__version__} (sha256 {hashlib.sha256(text).hexdigest()[:8]})"
    )


def _by_hand(package: Path, code: str) -> Iterator[str]:
    """Yield what people wrote in a package."""
    for region in list_regions(package):
        if region.state not in _BY_HAND or region.file == code:
            continue
        file = read_file(package, region.file) if region.id else None
        body = file.marked.regions[region.id].body if file is not None else None
        what = region.state if body is None else f"hand-written (sig {digest(body)})"
        yield f"{region.id or region.file}: {what}"
