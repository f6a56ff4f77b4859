"""Whether C99 is the program that was read: what is expected is written from forms of its own.

The functions that it calls are taken as they are: each must be one of the library, line by line.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from itertools import zip_longest
from pathlib import Path
from string import Template
from typing import TYPE_CHECKING

from eddi_scaffold.common.toml_tables import read_toml

if TYPE_CHECKING:
    from eddi_scaffold.program.instructions import Operation
    from eddi_scaffold.program.standalone import StandaloneMonitor

_FORMS = read_toml(Path(__file__).with_name("c_forms.toml"))
_TEXT_OR_COMMENT = re.compile(
    r"""(?mx) ("(?:[^"\\\n]|\\.)*")  # a text stays as it is
    | ^[ \t]* /\* (?:(?!\*/)[\s\S])* \*/ [ \t]*$  # lines of their own
    | /\* (?:(?!\*/).)* \*/  # a part of a line"""
)
_SPLICE = re.compile(r"(?:\\|\?\?/)\s*\n")  # joins lines before there are comments
_CALLED = re.compile(r"\b([a-z_]\w*)\(")
_BUFFER = re.compile("|".join(_FORMS["buffers"]))
_LETTER = re.compile(r"(?<![A-Z])[ABCKNRV](?![A-Z])")
_LIMIT = "INT64_C(4611686018427387903)"  # beyond, differences of times do not fit into 64 bits
_LEAVES = ("variable", "number", "truth", "literal")
_TYPES = {"number": "double ", "bool": "int ", "enum": "int ", "text": "const char *"}
_UNKNOWN = {"number": "NAN", "bool": "1", "enum": "-1", "text": "NULL"}
_KNOWN = {"number": "!isnan(X)", "bool": "X != 1", "enum": "X >= 0", "text": "X != NULL"}


def difference(
    model: StandaloneMonitor, texts: Mapping[str, str], types: str, functions: Mapping[str, str]
) -> tuple[str, int, str] | None:
    """Return file, line and what the model says, where the C is not what was read.

    Args:
        model: what was read.
        texts: file name -> text, of the header and the functions.
        types: of the library, which begin the header.
        functions: name -> text of those of the library.
    """
    expected = _Expected(model).files("\n".join(line for _, line in _lines(types)))
    for file, text in expected.items():
        written = texts.get(file, "")
        if splice := _SPLICE.search(written):
            number = written.count("\n", 0, splice.start()) + 1
            return file, number, "a line that goes on in the next one"
        blocks = {block.strip() for block in written.split("\n\n")}
        present = {name for name, function in functions.items() if function in blocks}
        called = functions.keys() & _CALLED.findall("\n".join(line for _, line in _lines(written)))
        if file.endswith(".c") and called != present:
            names = ", ".join(sorted(called ^ present))
            return file, 1, f"{names} is not as in the library"
        got = _lines(written, functions.values())
        for (number, line), (_, wanted) in zip_longest(got, _lines(text), fillvalue=(0, "")):
            if line != wanted:
                return file, number, f"{line!r}, the model says {wanted!r}"
    return None


def _lines(text: str, library: Iterable[str] = ()) -> Iterator[tuple[int, str]]:
    """Yield the lines with their numbers, without comments and functions of the library."""
    number = 1
    for block in text.split("\n\n"):
        plain = _TEXT_OR_COMMENT.sub(lambda of: of[1] or " " + "\n" * of[0].count("\n"), block)
        for k, line in enumerate(() if block.strip() in library else plain.split("\n")):
            if line.strip():
                yield number + k, line.strip()
        number += block.count("\n") + 2


class _Expected:
    def __init__(self, model: StandaloneMonitor) -> None:
        self.model, self.program = model, model.program
        self.operations = [*enumerate(self.program.operations)]
        absorbing = ("add", "sub", "mul")  # an overflow stays what it is inside of these
        self.used = {result.operation for result in self.program.results}
        self.finite = self.used.union(
            *(of.args for _, of in self.operations if of.op not in absorbing)
        )
        self.used.update(*(of.args for _, of in self.operations))

    def files(self, types: str) -> dict[str, str]:
        """Return the expected header and functions."""
        model, program, name = self.model, self.program, self.model.name
        results = [] if model.numeric else [*enumerate(program.results)]
        hazards = [str(of.hazard).lower() for of in program.results]
        back = "double" if model.numeric else "event_kleene" if len(results) == 1 else "void"
        value = "m->value" if model.numeric else "m->events[0].verdict"
        returned = "return;" if back == "void" else f"return {value};"
        arguments = ""
        for variable, read in zip(model.variables, program.reads, strict=True):
            arguments += f", {_TYPES[read.type]}v_{variable}"
            arguments += f", int64_t v_{variable}_stamp" * read.stamped
        enums = {f"{name}_{enum}_".upper(): words for enum, words in model.literals.items()}
        rows = [
            [f"{prefix}{of} = {k}" for k, of in enumerate(words)] for prefix, words in enums.items()
        ]
        if results:
            events = [f"{name}_{of}_".upper() + str(k) for k, of in enumerate(model.events)]
            rows.append([*events, f"{name.upper()}_EVENTS"])
        windows = any(of.window for _, of in self.operations)
        begins = ["m->value = NAN;"] if model.numeric else []
        for k, _ in results:
            begins += [f"m->events[{k}].verdict = EVENT_UNKNOWN;"]
            begins += [f"publish(&m->events[{k}], 1, {hazards[k]});"]
        for k, of in self.operations:
            begins += [f"m->w{k}.overflows = 0u;"] * (of.capacity > 0)
            begins += [f"m->c{k}.overflows = 0u;"] * (of.coverage is not None)
        registers = [f"{_TYPES[of.type]}r{k};" for k, of in self.operations if of.op not in _LEAVES]
        quiet = [
            f"m->events[{k}].{of} = false;" for k, _ in results for of in ("raised", "cleared")
        ]
        step = ["age = t - m->since;"] * windows + [*self._step()]
        if model.numeric:
            step += [f"m->value = {self._value(program.results[0].operation)};"]
        for k, result in results:
            step += [f"publish(&m->events[{k}], {self._value(result.operation)}, {hazards[k]});"]
        gap = f"}} else if (t - m->last > INT64_C({5 * program.period // 2})) {{\nm->since = t;"
        texts = {
            "name": name,
            "kind": model.kind,
            "guard": f"{name}_{model.kind}_H".upper(),
            "types": types,
            "enums": "\n".join("enum {\n" + ",\n".join(words) + "\n};" for words in rows),
            "results": "double value;"
            if model.numeric
            else f"event_output events[{len(results) or 1}];",
            "members": self._memory("members"),
            "signature": f"{back} {name}_step({name}_t *m, int64_t t_ns{arguments})",
            "texts": "#include <string.h>"
            * any(of.op == "is_covered" for _, of in self.operations),
            "forget": self._memory("resets") or "(void)m;",
            "reset": "\n".join(begins),
            "registers": "\n".join(["int64_t age, start;"] * windows + registers),
            "quiet": "\n".join([*quiet, returned]),
            "gap": gap if program.period else "",
            "step": "\n".join([*step, returned * (back != "void")]),
        }
        frames = {"h": _FORMS["frame"]["header"], "c": _FORMS["frame"]["functions"]}
        return {
            f"{name}_{model.kind}.{suffix}": Template(frame).substitute(texts)
            for suffix, frame in frames.items()
        }

    def _filled(self, form: str, k: int, of: Operation, args: Iterable[str] = ()) -> str:
        texts = {**dict(zip("ABC", args, strict=False)), "R": f"r{k}", "K": str(k)}
        texts |= {"N": str(of.capacity), "V": str(of.value)}
        form = _BUFFER.sub(lambda name: _FORMS["buffers"][name[0]], form)
        return _LETTER.sub(lambda letter: texts[letter[0]], form)

    def _memory(self, part: str) -> str:
        forms, rows = _FORMS[part], list[str]()
        for k, of in self.operations:
            names = [of.op, *(["covered"] if of.coverage is not None else [])]
            rows += [self._filled(forms[name], k, of) for name in names if name in forms]
        return "\n".join(rows)

    def _value(self, k: int) -> str:
        _, of = self.operations[k]
        if of.op == "variable":
            return f"v_{self.model.variables[int(of.value)]}"
        if of.op == "number":
            text = "(double)NAN" if of.value is None else repr(of.value)
            return f"({text})" if text[0] in "-(" else text
        return str(of.value) if of.op in ("truth", "literal") else f"r{k}"

    def _step(self) -> Iterator[str]:
        """Yield the lines that read the arguments and do all operations."""
        for k in range(len(self.program.reads)):
            yield from self._read(k)
        for k, of in self.operations:
            if of.op not in _LEAVES:
                yield self._operation(k, of)
        unused = (k for k, of in self.operations if of.op not in _LEAVES and k not in self.used)
        yield from (f"(void)r{k};" for k in unused)

    def _read(self, k: int) -> Iterator[str]:
        """Yield the lines that make a value UNKNOWN that is wrong or too old."""
        read, x = self.program.reads[k], f"v_{self.model.variables[k]}"
        lose, wrong = f"{{ {x} = {_UNKNOWN[read.type]}; }}", list[str]()
        if read.type in ("bool", "enum"):
            most = "> 2" if read.type == "bool" else f">= {len(read.literals)}"
            wrong = [f"{x} < 0 || {x} {most}"]
        elif read.type == "number":
            wrong = [] if read.infinite else [f"!isfinite({x})"]
            if read.range is not None:
                outside = f"!({read.range[0]!r} <= {x} && {x} <= {read.range[1]!r})"
                wrong += [f"isfinite({x}) && {outside}" if read.infinite else outside]
        yield from (f"if ({test}) {lose}" for test in wrong)
        if read.stamped:
            outside = f"{x}_stamp > {_LIMIT} || {x}_stamp < -{_LIMIT}"
            yield f"if ({outside}) {{ {x} = {_UNKNOWN[read.type]}; {x}_stamp = t; }}"
            yield f"if ({x}_stamp > t) {{"
            yield f"if ({x}_stamp - t > INT64_C({self.program.period})) {lose}"
            yield f"{x}_stamp = t;\n}}"
            if any(of.op == "age" and of.value == k for _, of in self.operations):
                known = _KNOWN[read.type].replace("X", x)
                yield f"if ({known}) {{ m->s{k} = {x}_stamp; m->has_s{k} = true; }}"
            if read.timeout is not None:
                yield f"if (t - {x}_stamp > INT64_C({read.timeout})) {lose}"

    def _operation(self, k: int, of: Operation) -> str:
        """Return the lines of an operation."""
        args, form = [*map(self._value, of.args)], _FORMS["operation"].get(of.op, "")
        if of.op in ("is_within", "is_covered"):
            return self._judged(f"r{k}", args[0], of)
        if of.window:
            full = f"age >= INT64_C({of.window - self.program.period})"
            start = f"start = t - INT64_C({of.window});\n"
            if form:
                return start + self._filled(form, k, of, args).replace("$full", full)
            return start + self._window(k, of, args[0], full)
        lines = self._filled(form, k, of, args)
        for more in args[2:] if of.op in ("and", "or") else ():
            lines += "\n" + self._filled(form, k, of, (f"r{k}", more))
        if of.op in ("neg", "add", "sub", "mul", "div") and k in self.finite:
            lines += f"\nif (!isfinite(r{k})) {{ r{k} = NAN; }}"
        return lines

    def _window(self, k: int, of: Operation, x: str, full: str) -> str:
        known = f"{x} != 1" if of.op == "count" else f"!isnan({x})"
        if self.operations[of.args[0]][1].infinite and not of.infinite:
            known = f"isfinite({x})"
        expire, add, value = (self._filled(form, k, of, [x]) for form in _FORMS["window"][of.op])
        ready, unknown, first = (
            f"{full} && m->w{k}.bad <= start",
            f"}} else {{\nm->w{k}.bad = t;\n",
            "",
        )
        if of.coverage is not None:
            first = (
                f"covered_add(&m->c{k}, m->c{k}_t, m->c{k}_k, {of.capacity}u, t, start, {known});\n"
            )
            share = f"(double)m->c{k}.known / (double)m->c{k}.size >= {of.coverage!r}"
            ready, unknown = f"{ready} && m->c{k}.bad <= start && {share}", ""
        taken = f"{first}{expire}\nif ({known}) {{\n{add}\n{unknown}}}\n"
        return f"{taken}r{k} = ({ready}) ? {value} : (double)NAN;"

    def _judged(self, r: str, x: str, of: Operation) -> str:
        """Return the lines that judge evidence: by texts or ranges that are good."""
        unknown, tests = f"{x} == NULL", list[str]()
        if of.op == "is_within":
            unknown = f"isnan({x})"
            for start, end, closed in of.value:
                low, high = (repr(v).replace("inf", "(double)INFINITY") for v in (start, end))
                tests.append(f"{low} <= {x} && {x} {'<=' if closed else '<'} {high}")
        for text in (text for text in of.value if of.op == "is_covered" and "\0" not in text):
            data = text.encode("utf-8", "surrogatepass")
            plain = (
                chr(n) if re.match(r"[\w .,:;+*/]", chr(n), re.ASCII) else f"\\{n:03o}"
                for n in data
            )
            tests.append(f'strcmp({x}, "{"".join(plain)}") == 0')
        whens = "".join(f"\nelse if ({test}) {{ {r} = 2; }}" for test in tests)
        return f"if ({unknown}) {{ {r} = 1; }}{whens}\nelse {{ {r} = 0; }}"
