"""Packages whose records name files of others, or are no records at all."""

from __future__ import annotations

import json

import yaml

from tests.hostile.world import World

BESIDE = "test/../../../../precious.txt"
"""In a scratch copy: the precious file in the folder of all temporary ones."""
DEEP = "[" * 100_000


def records_name_files_of_others(world: World) -> None:
    """What vanished from a rendering is removed, what was edited is copied: here, far outside."""
    others = [str(world.precious), BESIDE]
    _add_to_manifest(world, others)


def records_name_no_files(world: World) -> None:
    """Folders, a file as a folder, names that no disk can hold, the records themselves."""
    names = ["test", "EDDIInput.py/x", "a" * 300, "b/" * 3000 + "b", "\ud800", "\0", "", "a\nb"]
    _add_to_manifest(world, [*names, ".eddi/manifest.json", ".eddi", ".copier-answers.yml"])


def saved_bodies_of_odd_names(world: World) -> None:
    """A saved body says which file and region it is of: paths, and names that are none."""
    folder = world.eddi / "orphans"
    folder.mkdir()
    head = '# eddi-scaffold: saved body\n# region: {}\n# file: {}\n# sig: -\n# indent: ""\n# ---\n'
    for number, name in enumerate(["..", ".", "", "/", "../../x", str(world.precious)]):
        (folder / f"body{number}").write_text(head.format(name, name) + "hand = 1\n")


def manifest_too_deep_to_read(world: World) -> None:
    """A reader that calls itself for each bracket runs out of stack."""
    (world.eddi / "manifest.json").write_text(DEEP)


def configuration_too_deep_to_read(world: World) -> None:
    """The same in what the answers remember."""
    _answer(world, "config_json", DEEP)


def model_too_deep_to_read(world: World) -> None:
    """The same in the model."""
    _answer(world, "model_json", DEEP)


def answers_that_are_no_questions(world: World) -> None:
    """Keys of Copier's own, a template and names that are paths."""
    _answer(world, "_copier_conf", {"src_path": "/", "dst_path": str(world.precious.parent)})
    _answer(world, "_subdirectory", "..")
    _answer(world, "_tasks", [f"touch {world.mark}"])
    _answer(world, "_external_data", {"x": str(world.precious)})
    _answer(world, "model_file", str(world.precious))


def template_that_is_a_path(world: World) -> None:
    """The folder of the template is made of this answer."""
    _answer(world, "template", "plain_monitor/../ros1_runtime/../../../../../outside")


def modules_that_are_paths(world: World) -> None:
    """Names of files are made of this answer."""
    _answer(
        world, "aliases", [{"name": "../../x", "module": "x", "names": [], "monitor_names": []}]
    )


def answers_that_are_programs(world: World) -> None:
    """Templates are rendered, and nothing is forbidden them; answers are not."""
    program = f"{{{{ cycler.__init__.__globals__.os.system('touch {world.mark}') }}}}"
    for key in ("description", "maintainer_name", "license", "model_file", "unknown"):
        _answer(world, key, program)
    for key in ("readme", "sample_inputs"):
        _answer(world, key, [program])


BUILDERS = (
    records_name_files_of_others,
    records_name_no_files,
    saved_bodies_of_odd_names,
    manifest_too_deep_to_read,
    configuration_too_deep_to_read,
    model_too_deep_to_read,
    answers_that_are_no_questions,
    template_that_is_a_path,
    modules_that_are_paths,
    answers_that_are_programs,
)


def _add_to_manifest(world: World, names: list[str]) -> None:
    path = world.eddi / "manifest.json"
    manifest = json.loads(path.read_text())
    manifest["sha256"] |= dict.fromkeys(names, "0" * 64)
    path.write_text(json.dumps(manifest))


def _answer(world: World, key: str, value: object) -> None:
    path = world.package / ".copier-answers.yml"
    answers = yaml.safe_load(path.read_text("utf-8"))
    path.write_text(yaml.safe_dump({**answers, key: value}, sort_keys=False), "utf-8")
