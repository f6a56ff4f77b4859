"""How far a package is from what it would be if it were generated now."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from eddi_scaffold.packages.generation import write_packages
from eddi_scaffold.packages.handwritten import looked_at
from eddi_scaffold.packages.moved import moved_out, way_back
from eddi_scaffold.packages.rendering import ANSWERS_FILE, own_template
from eddi_scaffold.packages.upgrading import PackageGroup, targets
from eddi_scaffold.packages.workspace import linked_package
from eddi_scaffold.regions.generated import changed_generated


@dataclass(frozen=True)
class Drift:
    """The state of one package.

    Attributes:
        folder: name of the package folder, with that of its robot where there are several.
        outdated: files that a regeneration would change.
        edited: generated-only files that were edited.
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
        lines += [f"  edited, but generated: {path}" for path in self.edited]
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


def drift_of(group: PackageGroup, model: Path | None, configs: Sequence[Path]) -> list[Drift]:
    """Compare the packages of a group with a dry run of their regeneration."""
    packages, _ = targets(group, model, configs)
    outcome = write_packages(
        group.root, packages, own_template(), within=group.within, dry_run=True
    )
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
        edited = [str(path) for path in changed_generated(root)]
        regions = looked_at(root)
        states = Counter(str(region.state) for region in regions)
        findings = [line for line in outcome.left if line.startswith((f"{folder} ", f"{folder}/"))]
        findings += [
            ": ".join(filter(None, (r.file, r.id, "; ".join(r.notes)))) for r in regions if r.review
        ]
        reports.append(
            Drift(
                group.shown(folder),
                [p for p in changed if p not in edited],
                edited,
                dict(states),
                findings,
            )
        )
    links = (
        Drift(group.shown(link.name), [], [], {}, [linked_package(link)]) for link in group.links
    )
    return [*reports, *links, *_moved(group)]


def _moved(group: PackageGroup) -> Iterator[Drift]:
    """Yield the packages that a person moved to another place of the workspace."""
    moved = moved_out(group.root) if group.within is not None and group.root != group.within else {}
    for name, place in moved.items():
        finding = f"it was moved to {place}: {way_back(place, group.root / name)}"
        yield Drift(group.shown(name), [], [], {}, [finding])
