"""Models and configurations that name files of others."""

from __future__ import annotations

import json

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


def deployment_names_files_of_others(world: World) -> None:
    """Files elsewhere, a link that leads there, names that are paths, texts for a shell."""
    (world.work / "link.yml").symlink_to(world.precious)
    names = (
        str(world.precious),
        "../../outside/precious.txt",
        "link.yml",
        "/dev/zero",
        "arm.yml\0",
    )
    robots = [
        {"name": name, "namespace": f"/{name}", "monitors": [{"config": file, "model": file}]}
        for name in ("arm", "../../outside", f"$(touch {world.mark})")
        for file in names
    ]
    master = f"http://x; touch {world.mark} #"
    fine = {"name": "cart", "master": master, "monitors": [{"config": "cart_config.yml"}]}
    (world.work / "deployment.yml").write_text(json.dumps({"Robots": [*robots, fine]}), "utf-8")
    (world.work / "cell").mkdir()
    (world.work / "cell" / "cart").symlink_to(world.precious.parent)


def a_robot_in_the_shell(world: World) -> None:
    """A deployment that is fine, but for the texts of commands that are to be pasted."""
    text = (world.work / "deployment.yml").read_text("utf-8")
    master = f"platform: ros1\n    master: 'http://x; touch {world.mark} #'\n"
    (world.work / "deployment.yml").write_text(text.replace("platform: ros1\n", master), "utf-8")


def configurations_and_deployment(world: World) -> None:
    """Both: no command reads the two."""
    configurations_name_files_of_others(world)
    deployment_names_files_of_others(world)


def model_and_robot(world: World) -> None:
    """The same."""
    model_names_files_of_others(world)
    a_robot_in_the_shell(world)


BUILDERS = (configurations_and_deployment, model_and_robot)
