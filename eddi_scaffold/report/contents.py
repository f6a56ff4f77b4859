"""What a report says, gathered from hazards, proofs, tests and injected faults."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from eddi_scaffold.common.problems import Problem
from eddi_scaffold.deployments.hazards import ClaimSupport, HazardRow
from eddi_scaffold.deployments.injection import Row as Reaction
from eddi_scaffold.diagrams import Diagram, DiagramEdge, DiagramNode, LegendEntry
from eddi_scaffold.diagrams.svg import drawn
from eddi_scaffold.packages.verifying import Verified
from eddi_scaffold.report.formats import Case, Item, Key, Node, export_ids

_LEGEND = (
    LegendEntry("hazard, requirement", "box", "demand"),
    LegendEntry("guarantee", "rounded", "output"),
    LegendEntry("claim of another monitor", "rounded", "neutral"),
    LegendEntry("topic", "hexagon", "input"),
)


@dataclass(frozen=True)
class Report:
    """All of it; every format is a view of this."""

    project: str
    rows: Sequence[HazardRow]  # hazards and requirements of the EDDI
    findings: Sequence[Problem]  # what is missing between them and the guarantees
    verified: Mapping[str, Verified]  # by package
    tests: Mapping[str, Sequence[str]]  # package -> names of its vectors
    reactions: Sequence[Reaction]  # injected faults
    outdated: Sequence[str]  # monitors that faults were injected into, which are others by now

    @property
    def holds(self) -> bool:
        """Whether nothing is unlinked, differs, is not proved, fails, or is too late."""
        unlinked = (row for row in self.rows if row.item.kind == "hazard" and not row.is_linked)
        late = (of for of in self.reactions if of.verdict != "met" and not of.is_accepted)
        proofs = (of for of in self.verified.values() if not of.holds)
        errors = (of for of in self.findings if of.level == "error")
        return not any((*unlinked, *late, *proofs, *errors, *self.outdated))

    @cached_property
    def support(self) -> Mapping[str, ClaimSupport]:
        """Every claim that a hazard or requirement rests on, by name, guarantees first."""
        own = [of.claim for row in self.rows for of in row.guarantees]
        support = {of.claim: of for row in self.rows for of in row.support}
        order = [*own, *support]
        return {name: support[name] for name in dict.fromkeys(order) if name in support}

    @cached_property
    def guarantees(self) -> Mapping[str, Sequence[HazardRow]]:
        """The hazards and requirements of each guarantee."""
        of_claims: dict[str, list[HazardRow]] = {}
        for row in self.rows:
            for guarantee in row.guarantees:
                of_claims.setdefault(guarantee.claim, []).append(row)
        return of_claims

    def reactions_of(self, claim: str) -> list[Reaction]:
        """Return the faults that were injected to see a claim withdrawn."""
        return [of for of in self.reactions if f"{of.monitor}.{of.guarantee}" == claim]

    @cached_property
    def diagram(self) -> Diagram:
        """Hazards, the guarantees that are linked with them, and what these rest on."""
        nodes: dict[str, DiagramNode] = {}
        edges: dict[DiagramEdge, None] = {}
        for row in (row for row in self.rows if row.guarantees):
            box, states = f"row {row.item.path}", ", ".join(row.states)
            nodes[box] = DiagramNode(box, (row.item.name, states), "box", "demand")
            edges |= {DiagramEdge(of.claim, box): None for of in row.guarantees}
        for claim, support in self.support.items():
            node = DiagramNode(claim, (claim, support.known.as_text()), "rounded", "output")
            nodes[claim] = node if claim in self.guarantees else replace(node, tone="neutral")
            for of in chain.from_iterable(of.claims or of.topics for of in support.inputs):
                nodes.setdefault(of, DiagramNode(of, (of,), "hexagon", "input"))
                edges[DiagramEdge(of, claim)] = None
        text = "from topics up to claims, guarantees and the hazards that they are linked with"
        return Diagram(self.project, (*nodes.values(),), (*edges,), "up", _LEGEND, text)

    @cached_property
    def items(self) -> Sequence[Item]:
        """All that other tools import."""
        items: dict[Key, Item] = {}
        keys = self._keys
        for row in self.rows:
            item = row.item
            text = " ".join((item.condition, *item.risks))
            links = {"part of": [keys[of.path] for of in row.parts if of.path in keys]}
            place = f"{item.place.file}:{item.place.line}"
            items[keys[item.path]] = Item(
                keys[item.path], text.strip(), ", ".join(row.states), links, place
            )
            for part in row.parts:
                key = keys.setdefault(part.path, (part.kind, "", part.name))
                place = f"{part.place.file}:{part.place.line}"
                items.setdefault(key, Item(key, part.condition, "linked", {}, place))
        for claim, support in self.support.items():
            rows = self.guarantees.get(claim, ())
            rests = [self._claim_key(of) for input_ in support.inputs for of in input_.claims]
            topics = [("topic", "", of) for input_ in support.inputs for of in input_.topics]
            links = {"linked with": [keys[row.item.path] for row in rows], "rests on": rests}
            links["reads"] = topics
            text = f"by {', '.join(support.gates)}" if support.gates else ""
            key = self._claim_key(claim)
            items[key] = Item(key, text, support.known.as_text(), links)
            for topic in topics:
                items.setdefault(topic, Item(topic, "", "read"))
        for package, of in self.verified.items():
            key = ("testcase", package, "vectors")
            claims = [c for c, support in self.support.items() if support.package == package]
            links = {"of": [self._claim_key(claim) for claim in claims]}
            tested = ", ".join(of.evidence["tested"][:1])
            items[key] = Item(key, tested, state_of(of), links, of.model, of.sha256)
        return [*items.values()]

    @cached_property
    def _keys(self) -> dict[str, Key]:
        """The key of each hazard and requirement by its path; two of one name have the path too."""
        names = [(row.item.kind, row.item.name) for row in self.rows]
        keys: dict[str, Key] = {}
        for name, row in zip(names, self.rows, strict=True):
            title = row.item.name if names.count(name) == 1 else f"{row.item.name} {row.item.path}"
            keys[row.item.path] = (row.item.kind, "", title)
        return keys

    def _claim_key(self, claim: str) -> Key:
        monitor, _, name = claim.partition(".")
        return ("guarantee" if claim in self.guarantees else "evidence", monitor, name)

    @cached_property
    def argument(self) -> Sequence[Node]:
        """For each hazard and guarantee: it is withdrawn in time when its evidence is gone."""
        ids = export_ids([*self._keys.values(), *map(self._claim_key, self.support)])
        nodes: list[Node] = []
        for row in self.rows:
            for guarantee in row.guarantees:
                claim = guarantee.claim
                if row.item.kind == "hazard" and claim in self.support:
                    pair = (ids[self._keys[row.item.path]], ids[self._claim_key(claim)])
                    nodes += self._argument("_".join(pair), row, self.support[claim])
        return nodes

    def _argument(self, of: str, row: HazardRow, support: ClaimSupport) -> Iterator[Node]:
        claim, verified = support.claim, self.verified.get(support.package)
        reactions, url = self.reactions_of(claim), f"report.html#{support.package}"
        evidence = verified.evidence if verified is not None and verified.holds else {}
        proof, tested = ("; ".join(evidence.get(word, ())) for word in ("proved", "tested"))
        late = [reaction for reaction in reactions if reaction.verdict != "met"]
        in_time = f"{len(reactions)} faults" if reactions and not late else ""
        body = "hand-written bodies provide what their input means"
        goals = [
            ("G2", "compiled.py is the model", "Sn2", proof),
            ("G3", "the tests that come from the model pass", "Sn3", tested),
            ("G4", "it is withdrawn within the time that the hazard allows", "Sn4", in_time),
            ("G5", body, "Sn5", ""),  # no test of ours covers them
        ]
        top = f"{claim} is withdrawn in time when its evidence is gone ({row.item.title})"
        yield Node(f"G1_{of}", "goal", top, [f"S1_{of}"], [f"C1_{of}"])
        digest = f"{verified.model} (sha256 {verified.sha256})" if verified is not None else ""
        yield Node(f"C1_{of}", "context", digest or "its package was not looked at")
        yield Node(f"S1_{of}", "strategy", "text and time", [f"{id_}_{of}" for id_, *_ in goals])
        for id_, text, solution, shown in goals:
            supported = [f"{solution}_{of}"] if shown else []
            yield Node(f"{id_}_{of}", "goal", text, supported, (), not shown)
            if shown:
                yield Node(f"{solution}_{of}", "solution", shown, url=url)

    @property
    def suites(self) -> Mapping[str, tuple[Mapping[str, str], Sequence[Case]]]:
        """A suite of tests for each package: its proof, its vectors, and what none covers."""
        suites: dict[str, tuple[Mapping[str, str], Sequence[Case]]] = {}
        for package, of in self.verified.items():
            differs = [f"compiled.py:{finding.line}: {finding.text}" for finding in of.findings]
            cases = [Case(package, "verify", "; ".join(differs))]
            for name in self.tests.get(package, ()):
                failed = [line for line in of.evidence["tested"][1:] if name in line]
                cases.append(Case(f"{package}.vectors", name, "; ".join(failed)))
            cases += [Case(package, line, "", "written by hand") for line in of.evidence["not"]]
            suites[package] = ({"model_sha256": of.sha256}, cases)
        return suites


def page(report: Report) -> str:
    """Return the report as one page that needs nothing else: no script, no font, no link."""
    environment = Environment(
        loader=PackageLoader("eddi_scaffold", "report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return environment.get_template("page.html.jinja").render(
        report=report,
        states={package: state_of(of) for package, of in report.verified.items()},
        picture=Markup(drawn(report.diagram)),  # noqa: S704 - its texts are escaped where it is drawn
    )


def state_of(of: Verified) -> str:
    """Return what is known of a package, in a few words."""
    if any(finding.differs for finding in of.findings):
        return "differs"
    if of.findings:
        return "not proved"
    return "failed" if not of.holds else "proved, tested" if of.is_tested else "proved"
