"""What the documentation of common messages says: our table, and the shared one."""

import csv

from eddi_scaffold.common import units
from eddi_scaffold.config.field_types import Fields, element
from eddi_scaffold.monitors.message_types import common_messages
from eddi_scaffold.monitors.message_types.documented import _rows, documented
from tests.data_files import data_file

KNOWN = common_messages()
VAGUE = {"none", "mixed", "context", "undocumented"}


def fields_of(message: str) -> Fields | None:
    return KNOWN.get(message)


def spec(message: str, path: str) -> tuple[str, ...] | None:
    result = documented(message, path.split("."), fields_of)
    return None if result is None else result.units


def test_units_are_those_of_the_shared_table() -> None:
    """Every unit of a message that we know, and nothing where the table says there is none."""
    table = data_file("messages/units.tsv")
    with table.open(encoding="utf-8", newline="") as file:
        rows = [row for row in csv.DictReader(file, delimiter="\t") if row["type"] in KNOWN]
    assert len(rows) > 400
    wrong = []
    for row in rows:
        field = row["field"]
        expected = None if row["unit"] in VAGUE or field.endswith("stamp") else row["unit"]
        result = spec(row["type"], field)
        if "|".join(result or ()) != (expected or ""):
            wrong.append((row["type"], field, expected, result))
    assert wrong == []


def test_every_unit_is_one_of_the_table_and_every_path_is_a_field() -> None:
    for message, rows in _rows().items():
        for path, row in rows.items():
            assert all(units.find(unit) is not None for unit in row.units), row
            if message in KNOWN:
                of = message
                for name in path.removesuffix(".*").split("."):
                    inner = KNOWN[of][name.partition("[")[0]]
                    of = element(inner) or inner
