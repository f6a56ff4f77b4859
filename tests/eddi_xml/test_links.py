"""What an EDDI says around its monitored models: who refers to them, and what observes what."""

from dataclasses import replace
from pathlib import Path

from eddi_scaffold.eddi_xml.links import links_of
from eddi_scaffold.monitors.compiling import from_json
from eddi_scaffold.packages.assembly import assemble, monitors_of
from eddi_scaffold.packages.tracing import trace_of
from eddi_scaffold.platforms import platforms
from tests.eddi_xml.eddi_texts import parsed

MODELS = Path(__file__).parent / "models"
ROVER = (MODELS / "rover_hazards.xml").read_text("utf-8")
LANDING = (MODELS / "landing.xml").read_text("utf-8")
TREE = "//@odeProductPackages.2/@failureModels.0"


def linked(text: str) -> dict[str, list[str]]:
    return {path: [one.name for one in of.links] for path, of in links_of(parsed(text)[0]).items()}


def test_a_cause_leads_to_the_hazards_of_its_failure() -> None:
    """By reference; and by the name, where a cause has no failure."""
    found = linked(ROVER)
    assert found[f"{TREE}/@causes.0"] == ["Collision", "R1", "Brake"]
    assert found[f"{TREE}/@causes.1"] == ["E1", "Effect"]


def test_a_claim_rests_on_the_evidence_below_it() -> None:
    assert linked(ROVER)[TREE] == ["Sn1", "safe"]


def test_what_the_design_refers_to_is_no_link() -> None:
    design = (
        '<odeProductPackages xsi:type="design_:DesignPackage">'
        f'<systems name="Rover" model="{TREE}"/></odeProductPackages><assuranceCasePackages'
    )
    text = ROVER.replace("<assuranceCasePackages", design, 1)
    text = text.replace('name="Brake"/>', 'name="Brake" of="//@odeProductPackages.3/@systems.0"/>')
    assert linked(text) == linked(ROVER)


def test_references_by_id_are_links() -> None:
    text = ROVER.replace('<failures name="F" ', '<failures xmi:id="lost" name="F" ')
    by_path = f'failures="{TREE}/@failures.0"'
    assert by_path in text
    assert linked(text.replace(by_path, 'failures="lost"')) == linked(ROVER)


def test_an_event_leads_to_the_hazard_that_it_observes() -> None:
    """Evidence has the links of the events that its own event is made of."""
    found = linked(LANDING)
    events = "//@odeProductPackages.0/@systems.0/@keyValueMaps.0/@values"
    assert found == {
        f"{events}.5": ["FallsOnPerson"],
        f"{events}.4": ["FallsOnPerson"],
        "//@odeProductPackages.2/@conSerts.0/@runtimeEvidence.0": ["FallsOnPerson"],
    }


def test_a_guarantee_that_is_published_by_another_name_has_its_links() -> None:
    """As with `guarantee_ids: class`."""
    monitors, problems = monitors_of(MODELS / "landing.xml", [], "Landing")
    made, *_ = assemble(monitors, platforms()["plain"], MODELS / "none", problems).packages
    facts = from_json(made.answers["facts"])
    classes = {element.id: element.claim or element.id for element in facts.elements}
    claims = tuple(replace(claim, id=classes[claim.id]) for claim in facts.claims)
    renamed = replace(facts, claims=claims).to_json()
    rows = trace_of({**made.answers, "facts": renamed}).rows
    assert [row.links[0].through for row in rows if row.element == "guarantee"] == ["MotorFit"]


def test_many_references_are_cut_off() -> None:
    """An EDDI in which everything refers to everything takes no time for each pair."""
    every = " ".join(f"//@odeProductPackages.0/@hazards.{k}" for k in range(120))
    hazards = f'<hazards name="H" all="{every} {TREE}/@failures.0"/>' * 120
    found = linked(ROVER.replace("<hazards ", f"{hazards}<hazards ", 1))
    assert max(map(len, found.values())) == 100
    text = ROVER.replace("<hazards ", f"{hazards}<hazards ", 1)
    assert {len(one.links) for one in links_of(parsed(text)[0]).values() if one.is_cut} == {100}
