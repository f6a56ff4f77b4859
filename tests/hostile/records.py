"""Packages whose records name files of others, or are no records at all."""

from __future__ import annotations

import yaml

from tests.hostile.world import World

BESIDE = "test/../../../../precious.txt"
"""In a scratch copy: the precious file in the folder of all temporary ones."""
DEEP = "[" * 100_000


def records_name_files_of_others_or_none(world: World) -> None:
    """What vanished from a rendering is removed, what was edited is copied: here, far outside.

    And folders, a file as a folder, names that no disk can hold, the records themselves.
    """
    names = ["test", "EDDIInput.py/x", "a" * 300, "b/" * 3000 + "b", "\ud800", "\0", "", "a\nb"]
    names += [".eddi/manifest", ".eddi", ".copier-answers.yml", str(world.precious), BESIDE]
    lines = "".join(f"{'0' * 16} {name}\n" for name in names)
    with (world.eddi / "manifest").open("ab") as file:
        file.write(lines.encode("utf-8", "surrogatepass"))


def saved_bodies_of_odd_names(world: World) -> None:
    """The id of a saved body is a name of a file as well: paths, and names that are none."""
    folder = world.eddi / "kept"
    folder.mkdir()
    marked = "# -----Manual edit {}-----  # region: {}\n"
    for number, name in enumerate(["..", ".", "%00", "%2F", "../../x", str(world.precious)]):
        text = f"{marked.format('begin', name)}hand = 1\n{marked.format('end', name)}"
        (folder / f"body{number}.region").write_text(text)


def folders_of_records_that_lead_elsewhere(world: World) -> None:
    """What is kept, waits or is to be moved would be written to, or removed, far outside."""
    for name in ("kept", "new", "put"):
        (world.eddi / name).symlink_to(world.precious.parent)


def a_manifest_that_lies_elsewhere(world: World) -> None:
    """It would be replaced there."""
    (world.eddi / "manifest").rename(world.precious.with_name("manifest"))
    (world.eddi / "manifest").symlink_to(world.precious.with_name("manifest"))


def configuration_too_deep_to_read(world: World) -> None:
    """A reader that calls itself for each bracket runs out of stack."""
    _answer(world, "config", {"Model": DEEP})


def model_too_deep_to_read(world: World) -> None:
    """The same in the model."""
    _answer(world, "facts", DEEP)


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
    records_name_files_of_others_or_none,
    saved_bodies_of_odd_names,
    folders_of_records_that_lead_elsewhere,
    a_manifest_that_lies_elsewhere,
    configuration_too_deep_to_read,
    model_too_deep_to_read,
    answers_that_are_no_questions,
    template_that_is_a_path,
    modules_that_are_paths,
    answers_that_are_programs,
)


def _answer(world: World, key: str, value: object) -> None:
    path = world.package / ".copier-answers.yml"
    answers = yaml.safe_load(path.read_text("utf-8"))
    path.write_text(yaml.safe_dump({**answers, key: value}, sort_keys=False), "utf-8")
