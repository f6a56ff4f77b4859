"""Gathers what a report says: packages are verified, hazards followed, results of faults read."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import fields
from pathlib import Path

from eddi_scaffold.common.files import read_regular, read_source
from eddi_scaffold.common.problems import EddiError, Place, problem
from eddi_scaffold.deployments.hazards import Verification
from eddi_scaffold.deployments.injection import Row
from eddi_scaffold.deployments.support import facts_of_package
from eddi_scaffold.monitors.answers import VECTORS
from eddi_scaffold.packages.tracing import hazard_trace
from eddi_scaffold.packages.upgrading import PackageGroup
from eddi_scaffold.packages.verifying import Verified, verified
from eddi_scaffold.report.contents import Report


def gathered(
    project: str, groups: Sequence[PackageGroup], eddi: Path | None, faults: Path | None
) -> Report:
    """Return the report of packages, an EDDI with hazards, and what ``inject --json`` printed.

    Raises:
        EddiError: a package or a file cannot be used.
    """
    results: dict[str, Verified] = {}
    tests: dict[str, Sequence[str]] = {}
    present = [(group, *of) for group in groups for of in group.present.items()]
    for group, folder, answers in present:
        if "facts" in answers:
            results[folder] = verified(group, folder, None, ())
            file = group.root / folder / VECTORS
            data = json.loads(read_regular(file)) if file.is_file() else {}
            names = [row.split(" ", 2)[2] for row in data.get("vectors", ())]
            names += [name for name, _ in data.get("runs", ())]
            tests[folder] = [*dict.fromkeys(names)]
    wired = [facts_of_package(folder, answers) for _, folder, answers in present]
    monitors = [wire for wire in wired if wire is not None]
    known = {
        package: Verification(
            is_proved=not of.findings,
            is_tested=of.is_tested,
            result=", ".join(of.evidence["tested"][:1]),
        )
        for package, of in results.items()
    }
    folders = [group.root / folder for group, folder, answers in present if "facts" in answers]
    trace = hazard_trace(eddi, monitors, folders, known) if eddi is not None else None
    digests = {wire.name: wire.facts.digest for wire in monitors}
    reactions, injected = _injected(faults) if faults is not None else ((), {})
    return Report(
        project,
        [*trace.rows.values()] if trace is not None else (),
        [*trace.check()] if trace is not None else (),
        results,
        tests,
        reactions,
        [name for name, digest in injected.items() if digests.get(name, digest) != digest],
    )


def _injected(path: Path) -> tuple[Sequence[Row], Mapping[str, str]]:
    """Return the rows of a file of ``inject --json``, and the digest of each monitor."""
    source = read_source(path)
    try:
        data = json.loads(source.data)
        names = [field.name for field in fields(Row)]
        rows = [Row(**{name: row[name] for name in names}) for row in data["rows"]]
        return rows, {of["monitor"]: of["digest"] for of in data["monitors"]}
    except (ValueError, KeyError, TypeError) as failure:
        refused = problem("F003.faults", Place(str(path)), reason=failure)
        raise EddiError(refused) from None
