"""Reading of ``.rossystem`` and ``.ros*`` files, beside parsers made of a grammar.

Peers read the same texts where their grammar accepts them: lark (LALR with the contextual lexer)
and textX read the brace dialect, PyYAML with libyaml those files of the indentation dialect that
happen to be YAML. All are optional. Goals: at least twice as fast as lark, five times textX.

    python benchmarks/mros.py [--quick] [--json] [--corpus FOLDER]

Without ``--corpus`` a robot is made up: systems and node models of growing size.
"""

from __future__ import annotations

import argparse
import json
import statistics
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from eddi_scaffold.mros import MrosSyntaxError, read_ros_models, read_rossystem

Text = tuple[str, str]
"""``system`` or ``models``, and the content."""
Read = Callable[[Text], object]

LARK = Path(__file__).with_name("mros.lark")
TEXTX = Path(__file__).with_name("mros.tx")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer texts, fewer runs")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--corpus", type=Path, help="folder of .rossystem and .ros* files")
    options = parser.parse_args()
    texts = list(made_up(2 if options.quick else 6))
    if options.corpus:
        texts = [text for text in corpus(options.corpus) if is_read(ours, text)]
        texts = texts[::10] if options.quick else texts
    runs = 3 if options.quick else 5
    brace = [one for one in texts if one[1].lstrip().startswith(("RosSystem", "PackageSet"))]
    indent = [one for one in texts if one not in brace]
    systems = [one for one in brace if one[0] == "system"]
    rows = [
        row("brace", brace, "lark", lark_reader, runs),
        row("brace", systems, "textX", textx_reader, runs),
        row("indent", indent, "PyYAML (libyaml)", yaml_reader, runs),
    ]
    if options.json:
        print(json.dumps({"rows": rows}, indent=1))
    else:
        print_table(rows)


def ours(text: Text) -> object:
    return (read_rossystem if text[0] == "system" else read_ros_models)(text[1])


def lark_reader() -> Read:
    import lark

    parsers = {
        start: lark.Lark(LARK.read_text("utf-8"), parser="lalr", lexer="contextual", start=start)
        for start in ("system", "models")
    }
    return lambda text: parsers[text[0]].parse(text[1])


def textx_reader() -> Read:
    import textx

    meta = textx.metamodel_from_str(TEXTX.read_text("utf-8"))
    return lambda text: meta.model_from_str(text[1])


def yaml_reader() -> Read:
    import yaml

    loader = yaml.CSafeLoader
    return lambda text: yaml.load(text[1], Loader=loader)


def is_read(read: Read, text: Text) -> bool:
    try:
        return read(text) is not None
    except MrosSyntaxError:
        return False
    except Exception:  # noqa: BLE001 - whatever a peer raises: this text is not for it
        return False


def row(
    dialect: str, texts: Sequence[Text], peer: str, make: Callable[[], Read], runs: int
) -> dict[str, Any]:
    """Measure ours and the peer's in turn on what both read; the ratio is the median of pairs."""
    try:
        theirs = make()
    except ImportError as missing:
        seconds = min(timed(ours, texts) for _ in range(runs))
        case = f"{dialect}: {len(texts)} files"
        reason = f"not installed: {missing.name}"
        return result(case, texts, seconds, peer, None, None) | {"reason": reason}
    both = [text for text in texts if is_read(theirs, text)]
    pairs = [(timed(ours, both), timed(theirs, both)) for _ in range(runs)]
    ours_s = statistics.median(first for first, _ in pairs)
    peer_s = statistics.median(second for _, second in pairs)
    ratio = statistics.median(second / first for first, second in pairs)
    case = f"{dialect}: the {len(both)} of {len(texts)} files that {peer} reads"
    return result(case, both, ours_s, peer, peer_s, ratio)


def result(
    case: str, texts: Sequence[Text], ours_s: float, peer: str, peer_s: float | None, ratio: Any
) -> dict[str, Any]:
    megabytes = sum(len(content) for _, content in texts) / 1e6
    return {
        "case": case,
        "megabytes": megabytes,
        "ours_s": ours_s,
        "ours_mb_per_s": megabytes / ours_s if ours_s else None,
        "peer": peer,
        "peer_s": peer_s,
        "ratio": ratio,
    }


def timed(read: Read, texts: Sequence[Text]) -> float:
    start = time.process_time()
    for text in texts:
        read(text)
    return time.process_time() - start


def corpus(folder: Path) -> Iterator[Text]:
    for path in sorted(folder.rglob("*.ros*")):
        what = "system" if path.suffix == ".rossystem" else "models"
        yield what, path.read_bytes().decode("utf-8-sig")


def made_up(size: int) -> Iterator[Text]:
    """Return systems and models of both dialects, of 10, 20, ... nodes."""
    for nodes in range(10, 10 * size + 1, 10):
        names = [f"node_{number}" for number in range(nodes)]
        yield "system", brace_system(names)
        yield "models", brace_models(names)
        yield "system", indent_system(names)
        yield "models", indent_models(names)


def brace_system(names: Sequence[str]) -> str:
    interfaces = ", ".join(
        f"""RosPublisher '/{{0}}/topic_{i}' {{{{ RefPublisher "pkg.{{0}}.{{0}}.topic_{i}" }}}}"""
        for i in range(8)
    )
    component = (
        "  ComponentInterface {{ name '{0}' NameSpace '/{0}' FromRosNode \"pkg.{0}.{0}\"\n"
        f"    RosPublishers {{{{ {interfaces} }}}}\n"
        "    RosParameters {{ RosParameter p {{ RefParameter 'pkg.{0}.{0}.p' value 1 }} }} }}"
    )
    parts = ",\n".join(component.format(name) for name in names)
    return f"RosSystem {{ Name made_up RosComponents (\n{parts}\n) }}\n"


def brace_models(names: Sequence[str]) -> str:
    interfaces = ", ".join(
        f'Publisher {{ name topic_{i} message "std_msgs.Float64" }}' for i in range(8)
    )
    parts = ",\n".join(
        f"  Artifact {name} {{ Node {{ name {name} Publishers {{ {interfaces} }} }} }}"
        for name in names
    )
    return f"PackageSet {{ CatkinPackage pkg {{\n{parts}\n}} }}\n"


def indent_system(names: Sequence[str]) -> str:
    lines = ["made_up:", "  nodes:"]
    for name in names:
        lines += [f"    {name}:", f'      from: "pkg.{name}"', "      interfaces:"]
        lines += [f'        - t{i}: pub-> "{name}::topic_{i}"' for i in range(8)]
    return "\n".join(lines) + "\n"


def indent_models(names: Sequence[str]) -> str:
    lines = ["pkg:", "  artifacts:"]
    for name in names:
        lines += [f"    {name}:", f"      node: {name}", "      publishers:"]
        for i in range(8):
            lines += [f"        topic_{i}:", '          type: "std_msgs/msg/Float64"']
    return "\n".join(lines) + "\n"


def print_table(rows: Sequence[dict[str, Any]]) -> None:
    for one in rows:
        rate = f"{one['ours_mb_per_s']:.1f} MB/s" if one["ours_mb_per_s"] else ""
        print(f"{one['case']} ({one['megabytes']:.2f} MB)")
        print(f"  ours {one['ours_s']:.3f} s, {rate}")
        if one["peer_s"] is None:
            print(f"  {one['peer']}: {one['reason']}")
        else:
            print(f"  {one['peer']} {one['peer_s']:.3f} s, ratio {one['ratio']:.1f}")


if __name__ == "__main__":
    main()
