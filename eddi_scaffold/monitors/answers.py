"""From a monitor to the answers that every platform shares.

Everything that reaches a template as code is made here or in a platform: a checked identifier or a
ready literal. Templates put text in place and loop, nothing else.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from contextlib import suppress
from textwrap import wrap

from eddi_scaffold import __version__
from eddi_scaffold.common.escaping import (
    markdown_code,
    markdown_text,
    one_line,
    python_comment,
    python_literal,
)
from eddi_scaffold.common.identifiers import attribute
from eddi_scaffold.common.problems import EddiError
from eddi_scaffold.config.schema import Config
from eddi_scaffold.evidence.expressions import expression_rows
from eddi_scaffold.kinds import EditableMethod, JsonValue
from eddi_scaffold.monitors.binding import BoundMonitor
from eddi_scaffold.monitors.input_binding import InputBinding
from eddi_scaffold.program.runtime_parts import (
    LIFE_CYCLE,
    PEERS,
    TESTING,
    runtime_parts_of,
    with_needed,
)
from eddi_scaffold.regions.marked_file import parse
from eddi_scaffold.regions.markers import Digests, tail_of

ACCESS = ("by_id", "by_key", "by_name", "given", "joined")
"""Functions of the runtime that generated lines of ``process_<input>`` call."""
VECTORS = "test/vectors.json"
_OURS = ("compiled.py", ".bin", VECTORS)
_DEFAULT_MAINTAINER = "The users of this workspace <noreply@localhost.invalid>"


def files_of(monitor: BoundMonitor, code: str = "", text: str = "") -> dict[str, bytes]:
    """Return path -> content of the files that Copier does not render; the model as text is first.

    ``code`` is the folder of the Python package in it, ``text`` that of the model: with a slash.
    """
    model = monitor.unconfigured.named(monitor.model.name)
    files: dict[str, bytes] = {}
    with suppress(EddiError):  # its format cannot say it: there is none
        texts = {name: _as_kept(of) for name, of in model.write().items()}
        if not any(faults or marked.regions for marked, faults in map(parse, texts.values())):
            files = {f"{text}{name}": of.encode() for name, of in texts.items()}
    compiled = f"# fmt: off\n{monitor.compiled.text}\n".encode()
    tables = {f"{code}{name}": of for name, of in monitor.compiled.tables.items()}
    about = {"model": monitor.facts.file, "sha256": monitor.facts.file_sha256}
    about |= expression_rows(monitor.bound)
    vectors = monitor.model.vectors(monitor.bound, about)
    tests = {VECTORS: vectors.encode()} if vectors else {}
    return files | {f"{code}compiled.py": compiled} | tables | tests


def _as_kept(text: str) -> str:
    """Return a text of which a package keeps each byte: plain line ends, no blanks before them."""
    lines = text.lstrip("\ufeff").replace("\r\n", "\n").split("\n")
    return "\n".join(line.rstrip() for line in lines)


def shared_answers(
    monitor: BoundMonitor, template: str, files: Mapping[str, bytes]
) -> dict[str, JsonValue]:
    """Return the answers that all platforms ask for; ``files`` are what Copier does not render."""
    config, facts = monitor.config.config if monitor.config else None, monitor.facts
    title = f"{monitor.kind.title} {one_line(monitor.model.name)}"
    identity = identity_answers(monitor.package, f"Runtime monitor of the {title}", config)
    called = " ".join(binding.expression or "" for binding in monitor.inputs)
    parts = [*runtime_parts_of(monitor.compiled.text)]
    parts += [TESTING] if VECTORS in files else []
    if config is not None:
        parts += [PEERS] if config.Fleet is not None else []
        parts += with_needed([LIFE_CYCLE]) if config.Model.lifecycle else []
    readme = [one_line(line) for line in monitor.model.readme()]
    readme += ["", one_line(monitor.cross_check)] if monitor.cross_check else []
    return {
        "template": template,
        **identity,
        "description_markdown": markdown_text(identity["description"]),
        "kind": monitor.kind.name,
        "model_id_text": python_comment(monitor.model.name),
        "model_file": markdown_code(facts.file),
        "model_sha256": facts.file_sha256,
        "model_text": next((name for name in files if not name.endswith(_OURS)), ""),
        "inputs": [_input_answers(binding) for binding in monitor.inputs],
        "runtime_names": [name for name in ACCESS if f"{name}(" in called],
        "modules": [
            {
                "name": module.file.removesuffix(".py"),
                "docstring": module.docstring,
                "imports": list(module.imports),
                "class_name": module.class_name,
                "class_docstring": module.class_docstring,
                "plain_methods": list(module.plain_methods),
                "methods": [_method_answers(method) for method in module.methods],
            }
            for module in monitor.model.editable_modules()
        ],
        "aliases": [
            {
                "name": alias.name,
                "module": alias.module,
                "names": list(alias.names),
                "monitor_names": list(alias.monitor_names),
            }
            for alias in monitor.kind.aliases
        ],
        "readme": ["", *readme] if readme else [],
        "default_guarantees": list(monitor.default_guarantees),
        "config": monitor.config.as_data() if monitor.config else {},
        "parts": parts,
        "files": {name: hashlib.sha256(data).hexdigest() for name, data in files.items()},
        "facts": facts.to_json(),
    }


def _method_answers(method: EditableMethod) -> dict[str, JsonValue]:
    uses = _hash([method.name, *method.arguments, *method.uses])
    return {
        "name": method.name,
        "about": python_literal(method.about),
        "arguments": list(method.arguments),
        "returns": f" -> {method.returns}" if method.returns else "",
        "comments": list(method.comments),
        "before": list(method.before),
        "region": f"{method.name}{tail_of(Digests(uses=uses), method.was)}",
        "body": list(method.body),
        "after": list(method.after),
    }


def identity_answers(package: str, description: str, config: Config | None) -> dict[str, str]:
    """Return the answers for every package.xml."""
    section = config.Package if config else None
    maintainer = (section.maintainer if section else None) or _DEFAULT_MAINTAINER
    name, _, address = maintainer.rstrip(">").partition("<")
    return {
        "generator_version": __version__,
        "package": package,
        "package_version": section.version if section else "0.1.0",
        "description": one_line((section.description if section else None) or description),
        "maintainer_name": name.strip(),
        "maintainer_email": address.strip(),
        "license": section.license if section else "TODO",
    }


def _input_answers(binding: InputBinding) -> dict[str, JsonValue]:
    item = binding.model
    was = [f"process_{attribute(binding.renamed_from)}"] if binding.renamed_from else []
    # What the body may use: a change asks for a look at a hand-written one.
    pairs = zip(binding.arguments, binding.requires, strict=True)
    types = [f"{name}: {source.type}" for name, source in pairs]
    uses = Digests(uses=_hash([binding.attribute, item.type, binding.unit, *types]))
    is_computed, every = binding.computed is not None, item.every_message
    return {
        "id": python_literal(item.id),
        "title": markdown_code(item.id),
        "attribute": binding.attribute,
        "updater": "update_expression" if is_computed else "update_each" if every else "update",
        "type": markdown_text(f"{item.type} in {binding.unit}") if binding.unit else item.type,
        "default": python_literal(binding.default),
        "arguments": list(binding.arguments),
        "requires": python_literal(tuple(source.id for source in binding.requires)),
        "comments": _comments(binding),
        "region": f"process_{binding.attribute}{tail_of(uses, was)}",
        "body": _body(binding),
        "sources": _sources(binding),
        "covered": markdown_text(item.covered) if item.covered else "-",
        "age_text": "never" if binding.max_age in {None, "none"} else f"{binding.max_age} s",
    }


def _sources(binding: InputBinding) -> str:
    """Return the topics of an input, and which field or condition of their messages it is."""
    topics = ", ".join(f"`{markdown_code(s.topic or s.id)}`" for s in binding.requires)
    text = f": `{markdown_code(binding.text)}`" if binding.text else ""
    return f"{topics}{text}" if topics else "nothing"


def _comments(binding: InputBinding) -> list[str]:
    item = binding.model
    lines = []
    if item.description:
        lines.append(python_comment(item.description))
    unit = f" in {python_comment(binding.unit)}" if binding.unit else ""
    if binding.factor is not None:
        unit += f" (converted to {python_comment(item.unit or 'a ratio')})"
    good = f", good when {python_comment(item.covered)}" if item.covered else ""
    computed = f"; computed: {python_comment(binding.text)}" if binding.computed else ""
    return [*lines, f"{item.type}{unit}{good}{computed}"]


def _body(binding: InputBinding) -> list[str]:
    if binding.computed is not None:
        return [f"self.{binding.attribute} = self.expression({python_literal(binding.model.id)})"]
    if binding.expression is not None:
        return [f"self.{binding.attribute} = {binding.expression}"]
    arguments = ", ".join(binding.arguments) or "what you know"
    lines = [f"# TODO: set self.{binding.attribute} from {arguments}; None means unknown"]
    for name, of in (binding.known_fields or {}).items():
        fields = python_comment(f"{name} has {', '.join(f'.{field}' for field in of)}")
        lines += wrap(fields, 88, initial_indent="# ", subsequent_indent="#   ")
    return [*lines, f"self.{binding.attribute} = None"]


def _hash(uses: Sequence[str | None]) -> str:
    return hashlib.sha256(json.dumps(uses).encode()).hexdigest()[:8]
