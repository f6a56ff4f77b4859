"""Time and memory of reading the ConSerts of a large EDDI, beside the bare ``lxml.etree.parse``.

The file is synthetic: two ConSerts with their services among fault trees, one element per line as
EMF writes it. Every measurement runs in a process of its own, ours and the peer's in turn; goals:
at most 1.5 times the time of the bare parse, and no more memory.

    python benchmarks/eddi_xml.py [--quick] [--json]
"""

from __future__ import annotations

import argparse
import json
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PEER = "lxml.etree.parse"
CASES = {
    "read": "read the ConSerts",
    "survey": "survey every element and reference (show)",
}
HEAD = """<?xml version="1.0" encoding="UTF-8"?>
<integration_:DDIPackage xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"
 xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
 xmlns:consert_="http://www.deis-project.eu/ode/consert"
 xmlns:architecture_="http://www.deis-project.eu/ode/architecture"
 xmlns:failureLogic_="http://www.deis-project.eu/ode/failureLogic"
 xmlns:integration_="http://www.deis-project.eu/ode/integration" name="Benchmark">
"""
TAIL = "</integration_:DDIPackage>\n"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="a smaller file, fewer runs")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--child", nargs=2, metavar=("CASE", "FILE"), help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.child:
        print(json.dumps(measured(*options.child)))
        return
    megabytes, runs = (5, 3) if options.quick else (50, 7)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "large.xml"
        write_model(path, megabytes * 1_000_000)
        rows = [row(case, path, runs) for case in CASES]
    if options.json:
        print(json.dumps({"rows": rows}, indent=1))
    else:
        print_table(rows)


def write_model(path: Path, size: int) -> None:
    """Write an EDDI of at least ``size`` bytes."""
    with path.open("w", encoding="utf-8", newline="\n") as file:
        file.write(HEAD)
        for name in ("A", "B"):
            file.writelines(consert_package("AB".index(name), name))
        file.write('<odeProductPackages xsi:type="failureLogic_:FailureLogicPackage">\n')
        number = 0
        while file.tell() < size - 200:
            file.writelines(fault_tree(number))
            number += 1
        file.write("</odeProductPackages>\n")
        file.writelines(design_package())
        file.write(TAIL)


def consert_package(index: int, name: str) -> Iterator[str]:
    here = f"//@odeProductPackages.{index}/@conSerts.0"
    yield '<odeProductPackages xsi:type="consert_:ConSertPackage">\n'
    yield f'<conSerts name="ConSert{name}">\n'
    for i in range(20):
        yield f'<guaranteePropagation source="{here}/@runtimeEvidence.{i}"'
        yield f' target="{here}/@consertGates.0"/>\n'
    yield f'<guaranteePropagation source="{here}/@consertGates.0"'
    yield f' target="{here}/@guarantees.0"/>\n'
    service = f"//@odeProductPackages.3/@systems.0/@providedServices.{index}"
    yield f'<guarantees name="g" providedService="{service}">\n'
    yield from binary_dimension("guarantees")
    for i in range(20):
        yield f'<runtimeEvidence name="e{i}">\n'
        yield from binary_dimension("runtimeEvidence")
    yield '<consertGates name="all"/>\n</conSerts>\n</odeProductPackages>\n'


def binary_dimension(feature: str) -> Iterator[str]:
    yield '<dependabilityProperty>\n<dimension xsi:type="consert_:BinaryDimension">\n'
    yield '<dimensionType name="T"/>\n</dimension>\n</dependabilityProperty>\n'
    yield f"</{feature}>\n"


def fault_tree(number: int) -> Iterator[str]:
    here = f"//@odeProductPackages.2/@failureModels.{number}"
    yield f'<failureModels xsi:type="failureLogic_:FaultTree" name="Tree{number}">\n'
    for i in range(100):
        yield f'<failures Id="{i}" name="failure_{i}" originType="Internal">\n'
        yield '<failureProbDistribution type="Fit">\n'
        yield '<parameters name="Value" value="500.0"/>\n'
        yield "</failureProbDistribution>\n</failures>\n"
    for i in range(100):
        yield f'<causes xsi:type="failureLogic_:Gate" name="gate_{i}" causeType="Gate"'
        yield f' failure="{here}/@failures.{i}"'
        yield f' causes="{here}/@causes.{(i + 1) % 100} {here}/@causes.{(i + 2) % 100}"/>\n'
    yield "</failureModels>\n"


def design_package() -> Iterator[str]:
    yield '<odeProductPackages xsi:type="architecture_:DesignPackage">\n<systems name="S">\n'
    for name in ("A", "B"):
        yield f'<providedServices name="Service{name}">\n'
        yield f'<serviceType name="Service{name}Type"/>\n</providedServices>\n'
    yield "</systems>\n</odeProductPackages>\n"


def measured(case: str, file: str) -> dict[str, float]:
    """Run one case in this process.

    Returns:
        Seconds, peak memory in MB, and how much of that came after the imports.
    """
    run = {"bare": bare, "read": read, "survey": survey}[case](file)
    next(run)
    imported = peak_megabytes()
    start = time.perf_counter()
    next(run)
    seconds = time.perf_counter() - start
    peak = peak_megabytes()
    return {"seconds": seconds, "megabytes": peak, "growth": peak - imported}


def peak_megabytes() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


# Each case imports, stops, works, and stops while what it made is still there.


def bare(file: str) -> Iterator[None]:
    from lxml import etree

    yield
    tree = etree.parse(file)
    yield
    assert tree.getroot() is not None


def read(file: str) -> Iterator[None]:
    sys.path.insert(0, str(ROOT))
    from eddi_scaffold.common.files import read_source
    from eddi_scaffold.eddi_xml.document import read_document
    from eddi_scaffold.kinds.consert.read_eddi import read_eddi

    yield
    source = read_source(file)
    document, problems = read_document(source)
    assert document is not None
    conserts, more = read_eddi(document, source)
    assert len(conserts) == 2
    assert problems + more == []
    yield


def survey(file: str) -> Iterator[None]:
    sys.path.insert(0, str(ROOT))
    from eddi_scaffold.common.files import read_source
    from eddi_scaffold.eddi_xml.document import read_document
    from eddi_scaffold.eddi_xml.survey import survey as survey_of

    yield
    document, _ = read_document(read_source(file))
    assert document is not None
    assert survey_of(document)["references"]["unresolved"] == 0
    yield


def child(case: str, path: Path) -> dict[str, float]:
    command = [sys.executable, __file__, "--child", case, str(path)]
    result: dict[str, float] = json.loads(subprocess.check_output(command))
    return result


def row(case: str, path: Path, runs: int) -> dict[str, object]:
    """Measure ours and the peer's in turn; the ratio is the median of the pairs."""
    pairs = [(child(case, path), child("bare", path)) for _ in range(runs)]

    def medians(key: str) -> tuple[float, float]:
        return (
            statistics.median(ours[key] for ours, _ in pairs),
            statistics.median(peer[key] for _, peer in pairs),
        )

    ours_s, peer_s = medians("seconds")
    ours_mb, peer_mb = medians("megabytes")
    ours_growth_mb, peer_growth_mb = medians("growth")
    return {
        "case": f"{CASES[case]}, {path.stat().st_size / 1e6:.0f} MB",
        "ours_s": ours_s,
        "peer": PEER,
        "peer_s": peer_s,
        "ratio": statistics.median(peer["seconds"] / ours["seconds"] for ours, peer in pairs),
        "ours_mb": ours_mb,
        "peer_mb": peer_mb,
        "ours_growth_mb": ours_growth_mb,
        "peer_growth_mb": peer_growth_mb,
    }


def print_table(rows: list[dict[str, object]]) -> None:
    print(f"{'case':<50} {'ours':>9} {PEER:>17} {'ratio':>6}   peak MB (without imports)")
    for r in rows:
        print(
            f"{r['case']:<50} {r['ours_s']:>7.3f} s {r['peer_s']:>15.3f} s {r['ratio']:>6.2f}"
            f"   {r['ours_mb']:.0f} ({r['ours_growth_mb']:.1f})"
            f" / {r['peer_mb']:.0f} ({r['peer_growth_mb']:.1f})"
        )
    print("ratio = time of the bare parse / our time; goal for reading: at least 0.67")


if __name__ == "__main__":
    main()
