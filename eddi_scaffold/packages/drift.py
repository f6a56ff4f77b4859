"""How far a package is from what it would be if it were generated now."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from eddi_scaffold.packages.generation import write_packages
from eddi_scaffold.packages.handwritten import ADOPT, looked_at
from eddi_scaffold.packages.rendering import ANSWERS_FILE, own_template
from eddi_scaffold.packages.upgrading import PackageGroup, targets
from eddi_scaffold.packages.workspace import linked_package


@dataclass(frozen=True)
class PackageState:
    """The state of one package.

    Attributes:
        folder: name of the package folder, with that of its robot where there are several.
        outdated: files that a regeneration would change.
        edited: generated files that were edited outside regions.
        regions: state (``untouched``, ``edited``, ...) -> how many regions.
        review: hand-written bodies that need a look.
    """

    folder: str
    outdated: Sequence[str]
    edited: Sequence[str]
    regions: dict[str, int]
    review: Sequence[str]

    @property
    def drifted(self) -> bool:
        """Return whether something should be done."""
        return bool(self.outdated or self.edited or self.review)

    def as_text(self) -> str:
        """Return a few lines for people."""
        counts = (
            ", ".join(f"{count} {state}" for state, count in sorted(self.regions.items())) or "none"
        )
        lines = [
            f"{self.folder}: {'differs' if self.drifted else 'up to date'} (regions: {counts})"
        ]
        lines += [f"  would change: {path}" for path in self.outdated]
        lines += [f"  edited outside regions: {path}" for path in self.edited]
        lines += [f"  look at: {finding}" for finding in self.review]
        return "\n".join(lines)

    def as_json(self) -> dict[str, object]:
        """Return the JSON form of ``status --json``."""
        return {
            "package": self.folder,
            "drifted": self.drifted,
            "outdated": list(self.outdated),
            "edited": list(self.edited),
            "regions": self.regions,
            "review": list(self.review),
        }


def drift_of(
    group: PackageGroup, model: Path | None, configs: Sequence[Path]
) -> list[PackageState]:
    """Compare the packages of a group with a dry run of their regeneration."""
    packages, _ = targets(group, model, configs)
    outcome = write_packages(group.root, packages, own_template(), dry_run=True)
    reports = []
    for folder in group.present:
        root = group.root / folder
        changed = sorted(
            path.partition("/")[2]
            for path in outcome.changes
            if path.startswith(f"{folder}/")
            and "/.eddi/" not in path
            and not path.endswith(f"/{ANSWERS_FILE}")
        )
        regions = looked_at(root)
        edited = [region.file for region in regions if region.state == "outside"]
        states = Counter(region.state for region in regions if region.id)
        findings = [
            ": ".join(filter(None, (region.file, region.id, "; ".join(region.notes))))
            for region in regions
            if region.review and (region.state != "outside" or ADOPT in region.notes)
        ]
        reports.append(
            PackageState(
                group.shown(folder),
                [path for path in changed if path not in edited],
                edited,
                dict(states),
                findings,
            )
        )
    links = (
        PackageState(group.shown(link.name), [], [], {}, [linked_package(link)])
        for link in group.links
    )
    return [*reports, *links]
