"""How much runs on the robot, beside an earlier version in the same run.

For one monitor of each kind: lines and files of the runtime library in a ROS 1 workspace, all files
of that workspace, and the memory of a plain package after its first step, above bare Python. These
are sizes; ``start.py`` measures times.

    python benchmarks/runtime_size.py [--quick] [--json] [--old COMMIT]
"""

from __future__ import annotations

import json
import statistics
import subprocess
import sys
from pathlib import Path

from versions import EXAMPLES, Version, parser, versions

PROBE = """
def resident():
    with open("/proc/self/statm") as pages:
        return int(pages.read().split()[1]) * 4
before = resident()
from {package}.EDDIInput import EDDIInput
from {package}.EDDIMonitor import EDDIMonitor
EDDIMonitor().execute_step(EDDIInput())
print(resident() - before)
"""


def main() -> None:
    options = parser(__doc__).parse_args()
    rows = []
    with versions(options.old) as (new, old):
        for kind in EXAMPLES:
            ours, theirs = (sizes(one, kind, 1 if options.quick else 5) for one in (new, old))
            peer = {f"peer_{name}": value for name, value in theirs.items()}
            rows.append({"case": kind, **ours, "peer": options.old, **peer})
    if options.json:
        print(json.dumps({"rows": rows}, indent=1))
    else:
        print_table(rows)


def sizes(version: Version, kind: str, runs: int) -> dict[str, float]:
    """Return lines and files of the runtime, all files, and megabytes of memory."""
    packages, plain = version.workspace(kind), version.plain(kind)
    texts = [path.read_text() for path in packages.glob("eddi_runtime/src/**/*.py")]
    return {
        "lines": sum(text.count("\n") for text in texts),
        "files": len(texts),
        "all_files": sum(path.is_file() for path in packages.rglob("*")),
        "memory_mb": statistics.median(resident(plain) for _ in range(runs)) / 1024,
    }


def resident(package: Path) -> float:
    """Return the kilobytes that a monitor adds to a Python of its own."""
    command = [sys.executable, "-c", PROBE.format(package=package.name)]
    done = subprocess.run(
        command, cwd=package.parent, check=True, stdout=subprocess.PIPE, text=True
    )
    return float(done.stdout)


def print_table(rows: list[dict[str, object]]) -> None:
    print("| kind | runtime, lines | files | all | memory, MB |")
    print("|---|--:|--:|--:|--:|")
    for row in rows:
        cells = [
            f"{row[f'peer_{name}']:{form}} → {row[name]:{form}}"
            for name, form in (
                ("lines", ","),
                ("files", ""),
                ("all_files", ""),
                ("memory_mb", ".0f"),
            )
        ]
        print(f"| {row['case']} | {' | '.join(cells)} |")


if __name__ == "__main__":
    main()
