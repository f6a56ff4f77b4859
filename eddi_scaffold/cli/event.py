"""``eddi-scaffold event``: check a condition, try it on recorded values, generate its monitor."""

from __future__ import annotations

import json
import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from eddi_scaffold.cli.console import ExitStatus, console
from eddi_scaffold.cli.options import Output
from eddi_scaffold.common.files import Source, read_source
from eddi_scaffold.common.problems import EddiError, Problem, problem

if TYPE_CHECKING:
    from collections.abc import Mapping

    from eddi_scaffold.conditions.analysis import Analysis
    from eddi_scaffold.monitors.binding import BoundMonitor
    from eddi_scaffold.program.standalone import StandaloneMonitor


Target = Literal["python", "c"]


def event(
    text: Annotated[str | None, typer.Argument(metavar="[EXPR|FILE]")] = None,
    file: Path | None = None,
    rate: float | None = None,
    target: Target = "python",
    name: str | None = None,
    output: Output = None,
    check: bool = False,
    inputs: Path | None = None,
    config: Path | None = None,
    serve: bool = False,
    port: Annotated[int, typer.Option("--port", min=0, max=65535)] = 8765,
    as_json: bool = False,
) -> None:
    """Check a condition, or make Python or C99 of it.

    The C99 takes no heap.

    Without --check and --inputs, the monitor is written to --output; Python may go to stdout. With
    --target c, it may be that of a ConSert, too.

    Example: eddi-scaffold event "AVERAGE(temp, 5s) > 100" --rate 10 --target c -o monitor

    Args:
        text: An expression, a file of events, or one of a ConSert.
        file: A file of events.
        rate: Steps per second; windows need it.
        target: Language.
        name: What files and functions begin with.
        output: Folder for the files.
        check: Only check, and describe the condition. With --target c and --output: whether the C
            there is it.
        inputs: CSV with a column t and one per variable: try it.
        config: eddi_config.yml of a ConSert.
        serve: Open the page on 127.0.0.1, with the condition.
        port: Port of the page.
    """
    from eddi_scaffold.conditions.analysis import analyse
    from eddi_scaffold.conditions.standalone import as_json as report_json
    from eddi_scaffold.conditions.standalone import as_text, generate, monitor_model, without_limits
    from eddi_scaffold.conditions.tokens import EXPRESSION
    from eddi_scaffold.program.standalone import check_module_name, module_name

    # a text that is too long for a name, or has a NUL, is no file for `isfile`
    is_file = os.path.isfile(text or "") or (text or "").endswith(".events")  # noqa: PTH113
    path = Path(text) if text and (is_file or config is not None) else file
    if not serve and name is not None:
        check_module_name(name)
    if not serve and (None not in {text, file} or {text, file, config} == {None}):
        raise EddiError(problem("G000.argument"))
    if not serve and (config is not None or (path is not None and _is_model(path))):
        if inputs is not None or (check and output is None):
            raise EddiError(problem("E026.conditions"))
        from eddi_scaffold.monitors.exports import in_c

        report, monitor, printed = _of_model(path, config, target, name, as_json=as_json)
        if check and output is not None:
            _compare(printed, output, as_json=as_json)
        else:
            _write(report, in_c(monitor, printed), output, as_json=as_json)
        return
    source, label = text or "", EXPRESSION
    if path is not None:
        source, label = read_source(path).text("E001"), str(path)
    if serve:
        _serve(port, source, rate)
        return
    analysis = analyse(source, rate=rate, name=label)
    if analysis.program is None:
        if as_json:
            console.json(report_json(analysis))
            raise typer.Exit(ExitStatus.BAD_INPUT)
        raise EddiError(*analysis.problems)
    if target == "c" and not check and inputs is None:
        problems = (*analysis.problems, *without_limits(analysis, label))
        analysis = replace(analysis, problems=problems)
    stem = name or module_name(path.stem if path is not None else "event")
    if not as_json:
        console.problems(analysis.problems)
    if inputs is not None:
        _try(analysis, inputs, as_json=as_json)
    elif check and output is not None and target == "c":
        _compare(monitor_model(analysis, stem), output, as_json=as_json)
    elif check and as_json:
        console.json(report_json(analysis))
    elif check:
        console.data("\n".join(as_text(analysis)))
    else:
        files = generate(analysis, target, stem)
        _write(report_json(analysis), files, output, as_json=as_json)


def _try(analysis: Analysis, inputs: Path, *, as_json: bool) -> None:
    from eddi_scaffold.conditions.standalone import columns, play
    from eddi_scaffold.recordings.csv_recording import read_rows

    rows, problems = read_rows(read_source(inputs), dict(columns(analysis)))
    if rows is None:
        raise EddiError(*problems)
    if not as_json:
        console.problems(problems)
    key = "value" if analysis.events[0].type == "number" else "verdict"
    last = None
    for t, verdicts in play(analysis, rows):
        if as_json:
            outputs = [{"id": name, key: value} for name, value in verdicts.items()]
            alone = {key: outputs[0][key]} if len(outputs) == 1 else {}
            console.data(json.dumps({"t": t, **alone, "outputs": outputs}))
            continue
        shown = "  ".join(f"{name} {_shown(value)}" for name, value in verdicts.items())
        if shown != last:
            console.data(f"{t:10.3f}  {shown}")
        last = shown


def _shown(value: bool | float | None) -> str:
    if value is None:
        return "UNKNOWN"
    return str(value).upper() if isinstance(value, bool) else f"{value:.6g}"


def _is_model(path: Path) -> bool:
    from eddi_scaffold.eddi_xml.document import recognises as is_xml
    from eddi_scaffold.kinds import kinds

    source = read_source(path)
    of = next((kind.name for kind in kinds().values() if kind.recognises(source)), None)
    return of not in {None, "event"} or is_xml(source)


def _of_model(
    path: Path | None, config: Path | None, target: Target, name: str | None, *, as_json: bool
) -> tuple[dict[str, Any], BoundMonitor, StandaloneMonitor]:
    from eddi_scaffold.monitors.exports import standalone, without_limits
    from eddi_scaffold.packages.assembly import monitors_of, only

    monitors, problems = monitors_of(path, [config] if config is not None else [])
    # a file of several monitors may be given: the model says which
    monitor = only([of for of in monitors if of.model.source.name == str(path)] or monitors)
    problems = [*problems, *without_limits(monitor)]
    printed = standalone(monitor, target, name or monitor.package)
    if not as_json:
        console.problems(problems)
    report = {"problems": [problem.as_json() for problem in problems]}
    return report, monitor, printed


def _compare(model: StandaloneMonitor, folder: Path, *, as_json: bool) -> None:
    """Say whether the C in a folder is a monitor."""
    from eddi_scaffold.evidence.c_text import difference
    from eddi_scaffold.program.c_files import library, types

    names = [f"{model.name}_{model.kind}.{suffix}" for suffix in "hc"]
    texts = {name: read_source(folder / name).text("E001") for name in names}
    different = difference(model, texts, types(), library())
    rest = [f"{model.name}_{part}.c" for part in ("main", "vectors")]
    if as_json:
        keys = dict(zip(("file", "line", "text"), different, strict=True)) if different else None
        console.json({"proved": different is None, "differs": keys, "not_covered": rest})
    elif different is None:
        console.data(f"{', '.join(names)}: proved; not looked at: {' and '.join(rest)}")
    else:
        file, line, text = different
        console.data(f"{folder / file}:{line}: differs: {text}")
    if different is not None:
        raise typer.Exit(ExitStatus.NO)


def _write(
    report: Mapping[str, Any], files: Mapping[str, str], output: Path | None, *, as_json: bool
) -> None:
    """Write the files, or print them: the only one as it is, several as JSON."""
    from eddi_scaffold.packages.transaction import write
    from eddi_scaffold.program.standalone import keep_in_folder

    lost: list[str] = []
    if output is not None:
        files, lost = keep_in_folder(files, output)
        write(output, {file: text.encode() for file, text in files.items()})
    if as_json:
        console.json({**report, "files": files})
    elif output is not None:
        console.data("\n".join(str(output / file) for file in sorted(files)))
        if any(f.endswith(".h") for f in files) and not any("_vectors." in f for f in files):
            console.say("note: no test vectors: a window is long, or inputs are texts or computed")
    elif len(files) > 1:
        raise EddiError(problem("G000.folder"))
    else:
        console.data(next(iter(files.values())).rstrip("\n"))
    if lost:
        places = ", ".join(lost)
        console.complain(f"hand-written code has no place any more, it is kept in {places}")
        raise typer.Exit(ExitStatus.LOOK)


def _serve(port: int, text: str, rate: float | None) -> None:
    from eddi_scaffold.conditions.event_page import Page, open_server

    start = Page(text=text) if text else Page()
    start = start if rate is None else replace(start, rate=f"{rate:g}")
    with open_server(port, _read_signal, start) as server:
        console.say(f"the Event Creator is at http://127.0.0.1:{server.server_port}/ (Ctrl-C ends)")
        server.serve_forever()


def _read_signal(text: str, types: Mapping[str, Any]) -> tuple[Any, list[Problem]]:
    from eddi_scaffold.recordings.csv_recording import read_rows

    return read_rows(Source("<values>", text.encode()), types)
