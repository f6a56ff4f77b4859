"""Public models of other projects, where the shared data have a copy: no errors, all counts.

Sources: the DDI-Scripting-Tools of DEIS (MIT) and the MobSTr dataset of PANORAMA (EPL-2.0).
"""

from __future__ import annotations

import pytest

from eddi_scaffold.readers.eddi import read_document
from eddi_scaffold.readers.survey import survey
from eddi_scaffold.source import read_source
from tests.shared_data import shared

FILES = {
    "etcs.model": (628, 579),
    "trackside.model": (399, 217),
    "mobstr-contracts.dependability_": (34, 8),
    "mobstr-fmea.integration": (164, 242),
    "mobstr-fta-h1-omitted-braking-maneuver.ft.integration": (195, 126),
    "mobstr-fta-h2-omitted-avoidance-maneuver.ft.integration": (195, 126),
    "mobstr-fta-h3-unintended-braking.ft.integration": (195, 126),
    "mobstr-fta-h4-unintended-acceleration.ft.integration": (195, 126),
    "mobstr-fta-h5-unintended-leaving-of-the-road.ft.integration": (195, 126),
    "mobstr-fta.cft.integration": (466, 362),
    "mobstr-safetycase.integration": (374, 89),
}


@pytest.mark.parametrize("name", FILES)
def test_elements_and_references(name: str) -> None:
    document, problems = read_document(read_source(shared(f"public/{name}")))
    assert document is not None
    assert problems == []
    found = survey(document)
    assert (found.elements, found.references) == FILES[name]
    assert found.unresolved == 0
    assert found.models or "contracts" in name
