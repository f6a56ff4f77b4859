"""Processor time of generating and updating monitor packages, and of starting the command line.

The peer is Copier itself: the same answers, the same templates, no tasks, all packages in one
process that has imported Copier before the clock starts; `git` and all that is started counts.
Goals: one monitor generated in 1.5 s, and looked at again in 0.7 s; 50 upgraded in 5 s; `--help` in
0.3 s; plain `copier copy` with our tasks at most 1.5 times without them.

    python benchmarks/generate.py [--quick] [--json]
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from tests.checkouts import Checkout, checkout, git  # noqa: E402

FIRST, SECOND = "v900.0.0", "v900.1.0"
SHARED = 4
"""Packages that come with the first monitor: messages, launcher, runtime, metapackage."""
FEW = 6
"""Monitors that plain `copier update` is measured with: each one more takes as long as the last."""
HEAD = """<?xml version="1.0" encoding="UTF-8"?>
<integration_:DDIPackage xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"
 xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
 xmlns:consert_="http://www.deis-project.eu/ode/consert"
 xmlns:integration_="http://www.deis-project.eu/ode/integration" name="Benchmark">
<odeProductPackages xsi:type="consert_:ConSertPackage">
"""
CONSERT = """<conSerts name="Monitor{n}">
<guaranteePropagation source="{here}/@runtimeEvidence.0" target="{here}/@guarantees.0"/>
<guarantees name="works">{dimension}</guarantees>
<runtimeEvidence name="healthy">{dimension}</runtimeEvidence>
</conSerts>
"""
DIMENSION = """<dependabilityProperty><dimension xsi:type="consert_:BinaryDimension">
<dimensionType name="Fine"/></dimension></dependabilityProperty>"""
TAIL = "</odeProductPackages>\n</integration_:DDIPackage>\n"
CONFIG = """Model: {{id: Monitor{n}, type: ConSert, frequency: 10}}
SimulatorOutputs: [{{id: health, type: std_msgs.Bool, topic: /health{n}}}]
EDDIInputs: [{{id: healthy, requires: [health], default: false, max_age: 0.5}}]
EDDIOutputs: [{{id: monitor{n}, topic: /monitor{n}/guarantees}}]
"""
COPY = """
import json, os, sys, copier
started = sum(os.times()[:4])
for template, target, data in json.load(open(sys.argv[1])):
    copier.run_copy(template, target, data_file_data(data), vcs_ref="HEAD", defaults=True,
                    overwrite=True, unsafe=True, quiet=True, skip_tasks=SKIP)
print(sum(os.times()[:4]) - started)
"""
UPDATE = """
import json, os, sys, copier
started = sum(os.times()[:4])
for target in json.load(open(sys.argv[1])):
    copier.run_update(target, vcs_ref="TAG", defaults=True, overwrite=True, unsafe=True, quiet=True,
                      skip_tasks=SKIP)
print(sum(os.times()[:4]) - started)
"""
READ_YAML = "import yaml\ndata_file_data = lambda path: yaml.safe_load(open(path))\n"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer packages, one run")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    counts, runs = ((1, 3), 1) if options.quick else ((1, 10, 50), 3)
    rows = start_rows(5 if options.quick else 15)
    with tempfile.TemporaryDirectory() as folder:
        clone = checkout(Path(folder, "eddi-scaffold"), FIRST)
        release_second(clone)
        for count in counts:
            case = Case(Path(folder), clone, count)
            rows += case.copy_rows(runs if count < 50 else 1)
            rows.append(case.again_row(runs if count < 50 else 1))
            if not options.quick or count == 1:
                rows += case.update_rows(runs if count == 1 else 1)
    if options.json:
        print(json.dumps({"rows": rows}, indent=1))
    else:
        print_table(rows)


def release_second(clone: Checkout) -> None:
    """Change a text of an editable and of a generated file, and tag that."""
    node = "ros1_monitor/.eddi/new/{{ stage }}/scripts/RosNode.py.jinja"
    for name in ("eddi_input.py.jinja", node):
        path = clone.path / "copier_templates" / name
        path.write_text(path.read_text("utf-8").replace("enerated by", "enerated here by"), "utf-8")
    git(clone.path, "commit", "--quiet", "--all", "--message", "Second version")
    git(clone.path, "tag", SECOND)
    git(clone.path, "gc", "--quiet")  # as it is after `git clone`


class Case:
    """A number of monitors, their model and configurations."""

    def __init__(self, folder: Path, clone: Checkout, count: int) -> None:
        self.clone, self.count = clone, count
        self.folder = folder / str(count)
        self.folder.mkdir()
        self.model = self.folder / "model.xml"
        conserts = (
            CONSERT.format(n=n, here=f"//@odeProductPackages.0/@conSerts.{n}", dimension=DIMENSION)
            for n in range(count)
        )
        self.model.write_text(HEAD + "".join(conserts) + TAIL, "utf-8")
        self.configs = [self.folder / f"config{n}.yml" for n in range(count)]
        for n, config in enumerate(self.configs):
            config.write_text(CONFIG.format(n=n), "utf-8")
        self.fresh = 0

    @property
    def title(self) -> str:
        """Name the case."""
        return f"{self.count} monitor{'s' if self.count > 1 else ''}"

    def copy_rows(self, runs: int) -> list[dict[str, object]]:
        """Measure in pairs, ours and the peer's in turn."""
        git(self.clone.path, "checkout", "--quiet", FIRST)
        pairs = [(self.generate(), self.copy(skip=True)) for _ in range(runs)]
        tasks = [(self.copy(skip=False), self.copy(skip=True)) for _ in range(runs)]
        peer = f"{self.count + SHARED} x copier copy, no tasks"
        return [
            row(f"generate, {self.title}", peer, pairs),
            row(f"copier copy with tasks, {self.title}", peer, tasks),
        ]

    def again_row(self, runs: int) -> dict[str, object]:
        """Measure the command when nothing has changed; the peer would render everything."""
        git(self.clone.path, "checkout", "--quiet", FIRST)
        workspace = self.workspace()
        self._generate(workspace)
        pairs = [
            (timed(lambda: self._generate(workspace)), self.copy(skip=True)) for _ in range(runs)
        ]
        return row(f"the same again, {self.title}", f"{self.count + SHARED} x copier copy", pairs)

    def update_rows(self, runs: int) -> list[dict[str, object]]:
        """Measure in threes: upgrade, Copier with our tasks, Copier without."""
        found = [
            (self.upgrade(), self.update(skip=False), self.update(skip=True)) for _ in range(runs)
        ]
        of = f", from {FEW + SHARED}" if self.count > FEW else ""
        peer = f"{self.count + SHARED} x copier update, no tasks{of}"
        upgrades = [(upgrade, bare) for upgrade, _, bare in found]
        tasks = [(with_tasks, bare) for _, with_tasks, bare in found]
        return [
            row(f"upgrade, {self.title}", peer, upgrades),
            row(f"copier update with tasks, {self.title}", peer, tasks),
        ]

    def workspace(self) -> Path:
        """Make an empty catkin workspace."""
        self.fresh += 1
        path = self.folder / f"workspace{self.fresh}"
        (path / "src").mkdir(parents=True)
        return path

    def generate(self) -> float:
        """Time the whole command, with the start of Python."""
        return timed(lambda: self._generate(self.workspace()))

    def _generate(self, workspace: Path) -> None:
        configs = [word for config in self.configs for word in ("-c", config)]
        self.clone.eddi("-q", "generate", "-w", workspace, "-m", self.model, *configs)

    def copy(self, *, skip: bool) -> float:
        """Time Copier in one process, its import not counted."""
        target = self.workspace() / "src"
        jobs = [
            [str(self.clone.path), str(target / file.stem), str(file)] for file in self.answers()
        ]
        return child(READ_YAML + COPY.replace("SKIP", str(skip)), jobs, self.folder)

    def answers(self) -> Sequence[Path]:
        """Return the answers files of all packages, written once."""
        folder = self.folder / "answers"
        if not folder.exists():
            for config in self.configs:
                name = config.stem.replace("config", "Monitor")
                words = ("-o", folder, "-m", self.model, "-c", config, "--name", name)
                self.clone.eddi("-q", "answers", "--all", *words)
        return sorted(folder.glob("*.yml"))

    def upgrade(self) -> float:
        """Time the whole command on packages of the first version."""
        workspace = self.workspace()
        git(self.clone.path, "checkout", "--quiet", FIRST)
        self._generate(workspace)
        git(self.clone.path, "checkout", "--quiet", SECOND)
        return timed(lambda: self.clone.eddi("-q", "upgrade", "-w", workspace))

    def update(self, *, skip: bool) -> float:
        """Time Copier on the same packages in git; of many monitors, a few stand for all."""
        workspace = self.workspace()
        git(self.clone.path, "checkout", "--quiet", FIRST)
        self._generate(workspace)
        git(workspace, "init", "--quiet")
        git(workspace, "add", "--all")
        git(workspace, "commit", "--quiet", "--message", "All")
        answers = (workspace / "src" / "eddi_monitor").glob("*/.copier-answers.yml")
        packages = sorted(file.parent for file in answers)
        monitors = [package for package in packages if package.name.startswith("monitor")]
        shared = [package for package in packages if package not in monitors]
        few = monitors[:FEW]
        code = UPDATE.replace("SKIP", str(skip)).replace("TAG", SECOND)
        spent: dict[Path, float] = {}
        for package in (*shared, *few):
            spent[package] = child(code, [str(package)], self.folder)
            git(workspace, "add", "--all")
            git(workspace, "commit", "--quiet", "--allow-empty", "--message", "Updated")
        of_one = sum(spent[package] for package in few) / len(few)
        return sum(spent[package] for package in shared) + of_one * len(monitors)


def start_rows(runs: int) -> list[dict[str, object]]:
    """Measure how long it takes until the command line answers."""
    sources = os.pathsep.join([str(ROOT), str(ROOT / "runtime_lib" / "src")])
    bare = [sys.executable, "-c", "pass"]
    cases = {
        "eddi-scaffold --help": [sys.executable, "-m", "eddi_scaffold", "--help"],
        "import eddi_scaffold.packages.generation": [
            sys.executable,
            "-c",
            "import eddi_scaffold.packages.generation",
        ],
        "import eddi_runtime": [sys.executable, "-c", "import eddi_runtime"],
    }

    def start(command: list[str]) -> float:
        env = {**os.environ, "PYTHONPATH": sources}
        return timed(lambda: subprocess.run(command, env=env, check=True, capture_output=True))

    return [
        row(case, "python -c pass", [(start(command), start(bare)) for _ in range(runs)])
        for case, command in cases.items()
    ]


def timed(action: Callable[[], object]) -> float:
    """Return the processor time of what an action starts: the clock shows what else is running."""
    before = os.times()
    action()
    after = os.times()
    return sum(after[2:4]) - sum(before[2:4])


def child(code: str, jobs: object, folder: Path) -> float:
    """Run code that prints seconds in a process of its own."""
    file = folder / "jobs.json"
    file.write_text(json.dumps(jobs), "utf-8")
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", code, str(file)],
        check=True,
        stdout=subprocess.PIPE,
        text=True,
    )
    return float(done.stdout)


def row(case: str, peer: str, pairs: Sequence[tuple[float, float]]) -> dict[str, object]:
    return {
        "case": case,
        "ours_s": statistics.median(ours for ours, _ in pairs),
        "peer": peer,
        "peer_s": statistics.median(theirs for _, theirs in pairs),
        "ratio": statistics.median(theirs / ours for ours, theirs in pairs),
    }


def print_table(rows: Sequence[dict[str, object]]) -> None:
    print(f"{'case':<40} {'ours':>10} {'peer':>10} {'ratio':>6}   peer")
    for r in rows:
        print(
            f"{r['case']:<40} {r['ours_s']:>8.3f} s {r['peer_s']:>8.3f} s {r['ratio']:>6.2f}"
            f"   {r['peer']}"
        )
    print("ratio = time of the peer / our time")


if __name__ == "__main__":
    main()
