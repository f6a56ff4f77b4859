"""Links of guarantees, evidence and failures to what other packages hold."""

from eddi_scaffold.common.files import read_source
from eddi_scaffold.eddi_xml.document import read_document
from eddi_scaffold.eddi_xml.links import links_of
from tests.metamodel.expected import FOLDER, expected


def names_of(file: str) -> dict[str, list[str]]:
    """Return what each element is linked with, the nearest first."""
    document, _ = read_document(read_source(FOLDER / file))
    assert document is not None
    return {one.id: [link.name for link in one.links] for one in links_of(document).values()}


def test_links_lead_out_of_a_model_and_along_traces() -> None:
    names = names_of("13_all_in_one.xml")
    for element, wanted in expected()["13_all_in_one.xml"]["links"].items():
        assert set(wanted) <= {name.partition(" (")[0] for name in names[element]}
    assert names["CameraFit"] == ["SR-1"]
    assert names["GpsFit"][0] == "SR-GPS"
    assert "SR-GPS" not in names["ReturnHome"][:2]
