"""Models and configurations that name files of others."""

from __future__ import annotations

from tests.hostile.world import World

ENTITY = '<!DOCTYPE x [<!ENTITY secret SYSTEM "{}"><!ENTITY % all SYSTEM "{}"> %all;]>\n'


def configurations_name_files_of_others(world: World) -> None:
    """A model, events and a reference that lie elsewhere."""
    for name in ("eddi_config.yml", "consert_a_config.yml"):
        path = world.work / name
        text = path.read_text("utf-8").replace("Model:", "Model:\n  parameters: [{model: %s}]", 1)
        text = text.replace("EDDIInputs:", "EDDIInputs:\n  - {id: x, expression_file: %s}", 1)
        path.write_text(text.replace("%s", str(world.precious)), "utf-8")


def model_names_files_of_others(world: World) -> None:
    """Entities of an XML file."""
    path = world.work / "two_conserts.xml"
    head, rest = path.read_text("utf-8").split("\n", 1)
    entity = ENTITY.format(world.precious, world.precious)
    path.write_text(f"{head}\n{entity}{rest.replace('ConSertA', '&secret;', 1)}", "utf-8")


BUILDERS = (configurations_name_files_of_others, model_names_files_of_others)
