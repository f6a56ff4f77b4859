"""One test for each rule of the merge."""

from __future__ import annotations

import textwrap
from dataclasses import replace

import pytest

from eddi_scaffold.regions.manifest import digests_of
from eddi_scaffold.regions.marked_file import parse
from eddi_scaffold.regions.merge import merge, retire
from eddi_scaffold.regions.result import Merged, Orphan, RefusedFile
from tests.regions.rendering import (
    CMAKE,
    INPUT,
    MANIFEST,
    NETWORK,
    RENDER,
    Element,
    Package,
    elements,
    renamed,
)

A, B, C = elements("a", "b", "c")


def text(*names: Element, version: int = 1, path: str = INPUT) -> str:
    return RENDER[path](Package(names, version))


def edit(old: str, name: str, code: str, path: str = INPUT) -> str:
    kind = {INPUT: "input", MANIFEST: "xml", CMAKE: "cmake"}.get(path, "node")
    region = parse(old)[0].regions[f"{kind}:{name}"]
    block = f"{region.begin}\n{region.body}{region.end}\n"
    assert old.count(block) == 1
    return old.replace(
        block, f"{region.begin}\n{textwrap.indent(code, region.indent)}{region.end}\n"
    )


def merged(
    base: str | None, mine: str | None, theirs: str, path: str = INPUT, orphans=()
) -> Merged:
    result = merge(path, base, mine, theirs, orphans)
    assert isinstance(result, Merged), result
    assert result.text is not None
    again = merge(path, base, result.text, theirs)  # killed before the base was written
    assert isinstance(again, Merged)
    assert again.text == result.text
    after = merge(path, theirs, result.text, theirs)
    assert isinstance(after, Merged)
    assert (after.text, after.patch, after.orphans) == (result.text, "", ())
    return result


def body(result: Merged, region: str) -> str:
    return parse(result.text or "")[0].regions[region].body


def test_untouched_regions_take_the_new_default() -> None:
    base, theirs = text(A, B), text(B, C, A, version=2)
    assert merged(base, base, theirs).text == theirs


def test_body_equal_to_the_new_default_is_untouched() -> None:
    base = text(A)
    theirs = base.replace("self.a = message.data", "self.a = message.value")
    result = merged(base, edit(base, "a", "self.a = message.value\n"), theirs)
    assert result.text == theirs


def test_edited_body_is_kept_byte_for_byte() -> None:
    code = "x  =  1   \n\n\tif x: pass\n'''\nflush left\n   '''\n# end\n"
    base = text(A, B)
    mine = edit(base, "a", "X").replace("        X", code)
    result = merged(base, mine, text(C, B, A, version=3))
    assert body(result, "input:a") == code
    assert body(result, "input:b") == "        self.b = message.data\n"


def test_emptied_body_stays_empty() -> None:
    base = text(A)
    assert body(merged(base, edit(base, "a", ""), text(A, B, version=2)), "input:a") == ""


def test_signature_of_an_edited_body_stays_and_is_told() -> None:
    base = text(A)
    mine = edit(base, "a", "self.a = 1\n")
    changed = replace(A, states=("low", "high"))
    result = merged(base, mine, text(changed))
    assert f"input:a sig: {A.sig}" in (result.text or "")
    assert any("other inputs or states" in n.text for n in result.notes)
    assert f"sig: {changed.sig}" in (merged(base, base, text(changed)).text or "")


def test_base_missing_keeps_bodies_and_rejects_the_rest() -> None:
    old = text(A)
    mine = edit(old, "a", "self.a = 1\n").replace(
        "import EDDIInputBase", "import EDDIInputBase as X"
    )
    result = merged(None, mine, text(A, version=2))
    assert body(result, "input:a") == "        self.a = 1\n"
    assert "+from eddi_runtime import EDDIInputBase as X" in result.patch
    assert "as X" not in (result.text or "")


def test_body_moves_with_its_marker() -> None:
    base = text(A)
    mine = edit(base, "a", "if True:\n    self.a = '''\nkeep\n'''\n").replace(
        "        keep", "keep"
    )
    theirs = "if True:\n" + textwrap.indent(base, "    ")
    result = merged(base, mine, theirs)
    lines = body(result, "input:a").split("\n")
    assert lines[:2] == ["            if True:", "                self.a = '''"]
    assert "keep" in lines


def test_stripped_marker_is_put_right() -> None:
    base = text(A, B)
    mine = edit(base, "a", "self.a = 7\n")
    stripped = "".join(
        (line.strip() + "\n") if "Manual edit" in line else line for line in mine.splitlines(True)
    )
    assert (
        merged(base, stripped, text(A, B, version=2)).text
        == merged(base, mine, text(A, B, version=2)).text
    )


def test_declared_rename_carries_the_body() -> None:
    base = text(A, B)
    result = merged(base, edit(base, "a", "hand = 1\n"), text(B, renamed(A, "z")))
    assert body(result, "input:z") == "        hand = 1\n"
    assert not result.orphans


def test_rename_onto_own_hand_code_saves_the_old_body() -> None:
    base = text(A, B)
    mine = edit(edit(base, "a", "hand = 1\n"), "b", "gone = 1\n")
    result = merged(base, mine, text(replace(B, was=("a",))))
    assert body(result, "input:b") == "        hand = 1\n"
    assert [(o.id, o.body) for o in result.orphans] == [("input:b", "        gone = 1\n")]
    assert any("is what was 'input:a' now; its body is saved" in n.text for n in result.notes)


def test_names_that_swap_swap_their_bodies_once() -> None:
    base = text(A, B, C)
    mine = edit(edit(base, "a", "of_a = 1\n"), "b", "of_b = 1\n")
    theirs = text(replace(A, was=("b",)), replace(B, was=("a",)), C)
    result = merged(base, mine, theirs)
    assert body(result, "input:a") == "        of_b = 1\n"
    assert body(result, "input:b") == "        of_a = 1\n"
    assert not result.orphans
    assert [n.text for n in result.notes if not n.attention] == [
        "region 'input:b' is called 'input:a' now; its body moved along",
        "region 'input:a' is called 'input:b' now; its body moved along",
    ]
    later = merged(theirs, result.text, theirs.replace("Inputs of", "All inputs of"))
    assert body(later, "input:a") == "        of_b = 1\n"


def test_a_body_that_is_the_new_text_of_its_old_name_moves_along() -> None:
    base = text(A, B).replace("self.a = message.data", "self.a = 0")
    mine = edit(base, "a", "self.a = message.data\n")
    result = merged(base, mine, text(replace(A, was=("b",)), replace(B, was=("a",))))
    assert body(result, "input:b") == "        self.a = message.data\n"


def test_names_that_move_up_take_their_bodies_along() -> None:
    base = text(A, B)
    mine = edit(edit(base, "a", "of_a = 1\n"), "b", "of_b = 1\n")
    theirs = text(A, replace(B, was=("a",)), replace(C, was=("b",)))
    result = merged(base, mine, theirs)
    assert [body(result, f"input:{name}").strip() for name in "abc"] == [
        "self.a = message.data",
        "of_a = 1",
        "of_b = 1",
    ]
    assert any("'input:a' is another one now" in n.text and n.attention for n in result.notes)


def test_names_that_move_up_again_are_declared_in_the_same_words() -> None:
    once = text(A, replace(B, was=("a",)), replace(C, was=("b",)))
    mine = edit(edit(edit(once, "a", "of_a = 1\n"), "b", "of_b = 1\n"), "c", "of_c = 1\n")
    other = elements("d")[0]
    twice = text(A, replace(B, was=("a",)), replace(C, was=("b",)), replace(other, was=("c",)))
    result = merged(once, mine, twice)
    assert [body(result, f"input:{name}").strip() for name in "abcd"] == [
        "self.a = message.data",
        "of_a = 1",
        "of_b = 1",
        "of_c = 1",
    ]


def test_what_was_written_around_a_region_does_not_pass_to_another_element() -> None:
    base = text(A, B)
    end = "# region: input:a\n"
    mine = base.replace(f"edit end-----'''  {end}", f"edit end-----'''  {end}        self.a += 1\n")
    mine = mine.replace("import EDDIInputBase\n", "import EDDIInputBase\nimport math\n")
    assert mine.count("self.a += 1") == 1
    result = merged(base, mine, text(replace(A, was=("b",)), replace(B, was=("a",))))
    assert "self.a += 1" not in (result.text or "")
    assert "+        self.a += 1" in result.patch
    assert "import math" in (result.text or "")
    assert any("was not renamed" in n.text for n in result.notes)


def test_former_id_of_two_regions_is_used_once() -> None:
    base = text(A)
    theirs = text(renamed(A, "y"), renamed(A, "z"))
    result = merged(base, edit(base, "a", "hand = 1\n"), theirs)
    assert (result.text or "").count("hand = 1") == 1
    assert [n.text for n in result.notes if n.attention] == [
        "'input:z' and 'input:y' are both declared as 'input:a' before"
    ]


def test_vanished_body_is_saved_and_comes_back() -> None:
    base = text(A, B)
    gone = merged(base, edit(base, "a", "hand = 1\n"), text(B))
    assert [(o.id, o.file, o.sig) for o in gone.orphans] == [("input:a", INPUT, A.sig)]
    back = merged(text(B), gone.text, text(A, B), orphans=gone.orphans)
    assert body(back, "input:a") == "        hand = 1\n"
    assert back.taken == gone.orphans


def test_saved_body_yields_to_hand_code() -> None:
    saved = Orphan("input:a", INPUT, None, "        ", "        saved = 1\n")
    mine = edit(text(A), "a", "own = 1\n")
    result = merged(text(A), mine, text(A), orphans=(saved,))
    assert not result.taken
    assert body(result, "input:a") == "        own = 1\n"


def test_region_without_id_is_adopted() -> None:
    old = "\n".join(line.split("  # region")[0] for line in text(A, B).split("\n"))
    mine = old.replace("self.a = message.data", "hand = 1")
    result = merged(None, mine, text(B, A, version=2))
    assert body(result, "input:a") == "        hand = 1\n"
    assert "hand" not in body(result, "input:b")


def outside(base: str, theirs: str, old: str, new: str) -> Merged:
    assert old in base
    return merged(base, base.replace(old, new, 1), theirs)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("import EDDIInputBase\n", "import EDDIInputBase\nimport math\n"),
        ("\n    def process_b", "\n    def helper(self):\n        return 1\n\n    def process_b"),
        ("__init__()\n", "__init__()\n        self.count = 0\n"),
        ("        self.b = False\n", "        self.b = False\n        self.count = 0\n"),
        ("# region: input:a\n", "# region: input:a\n        self.count = 0\n"),
        ("class EDDIInput", "LIMIT = 3\n\n\nclass EDDIInput"),
        ("EDDIInput(EDDIInputBase):\n", "EDDIInput(EDDIInputBase):\n    limit = 3\n\n"),
        ("\n    def process_b", "\n    # about b\n    def process_b"),
        ("simulator_outputs)\n", "simulator_outputs)\n        self.after_all()\n"),
    ],
)
def test_outside_edits_are_merged(old: str, new: str) -> None:
    base, theirs = text(A, B), text(C, B, A, version=2)
    result = outside(base, theirs, old, new)
    added = set(new.split("\n")) - set(old.split("\n"))
    assert result.patch == ""
    assert added - set(theirs.split("\n")) <= set((result.text or "").split("\n"))


def test_helper_stays_behind_its_neighbour() -> None:
    helper = "\n    def helper(self):\n        return 1\n"
    result = outside(
        text(A, B, C), text(C, A, B), "\n    def process_b", f"{helper}\n    def process_b"
    )
    names = [w.split("(")[0] for w in (result.text or "").split("def ")[1:]]
    assert names == ["__init__", "process_c", "process_a", "helper", "process_b", "processing"]


def test_lines_never_cross_definitions() -> None:
    base = text(A, B)
    mine = base.replace("# region: input:a\n", "# region: input:a\n        self.hand = 1\n")
    result = merge(INPUT, base, mine.replace("2b", "2b"), text(B))
    assert isinstance(result, Merged)
    assert "self.hand" not in (result.text or "")
    assert "+        self.hand = 1" in result.patch


def test_imports_are_united() -> None:
    base = "from m import a\n\nx = 1\n"
    result = merged(
        base, "from m import a, b as c\n\nx = 1\n", "from m import a, d\n\nx = 1\n", "f.py"
    )
    assert result.text == "from m import a, d\nfrom m import b as c\n\nx = 1\n"


def test_conflict_is_rejected_and_theirs_wins() -> None:
    base, theirs = "x = 1\n\n\ndef f():\n    return 1\n", "x = 2\n\n\ndef f():\n    return 2\n"
    result = merged(
        base, "x = 3\n\n\ndef f():\n    return 3\n\n\ndef g():\n    return 4\n", theirs, "f.py"
    )
    assert result.text == theirs + "\n\ndef g():\n    return 4\n"
    assert "+x = 3" in result.patch
    assert "+    return 3" in result.patch
    assert "<<<<" not in (result.text or "")


def test_text_without_its_markers_is_refused() -> None:
    base = text(A, B)
    start, rest = base.split("        '''-----Manual edit begin-----'''  # region: input:a", 1)
    mine = start + "        self.a = 5\n" + rest.split("# region: input:a\n", 1)[1]
    result = merge(INPUT, base, mine, base)
    assert isinstance(result, RefusedFile)
    line = mine.split("\n").index("        self.a = 5") + 1
    assert [fault.line for fault in result.faults] == [line]


def test_own_region_of_a_person_stays() -> None:
    base = text(A)
    marked = "        '''-----Manual edit {}-----'''  # region: my:own\n"
    own = f"\n    def helper(self):\n{marked.format('begin')}        x = 1\n{marked.format('end')}"
    mine = base.replace("\n    def processing", f"{own}\n    def processing")
    result = merged(base, mine, text(B, A, version=2))
    assert own in (result.text or "")
    assert not result.orphans


def test_line_ends_stay() -> None:
    base = text(A, B)
    mine = edit(base, "a", "hand = 1\n").replace("\n", "\r\n")
    result = merged(base, mine, text(B, A, version=2))
    assert result.text is not None
    assert result.text.count("\r\n") == result.text.count("\n") > 0
    bom = merged(base, "\ufeff" + mine, text(B, A, version=2))
    assert bom.text == "\ufeff" + result.text


def test_body_that_does_not_compile_is_kept_and_told() -> None:
    base = text(A)
    result = merged(base, edit(base, "a", "if (\n"), text(A, B, version=2))
    assert body(result, "input:a") == "        if (\n"
    assert any("not valid" in n.text for n in result.notes)


def test_damaged_markers_are_refused() -> None:
    base = text(A)
    result = merge(INPUT, base, base.replace("Manual edit end", "Manual end"), base)
    assert isinstance(result, RefusedFile)
    assert result.faults[0].line > 1


def test_xml_is_merged_by_lines_and_stays_valid() -> None:
    base, theirs = text(A, B, path=MANIFEST), text(A, B, C, version=2, path=MANIFEST)
    mine = edit(base, "depends", "<depend>tf</depend>\n", MANIFEST)
    mine = mine.replace("  <name>pkg</name>\n", "  <name>pkg</name>\n  <license>MIT</license>\n")
    result = merged(base, mine, text(A, B, C, path=MANIFEST), MANIFEST)
    assert "<depend>tf</depend>" in (result.text or "")
    assert "<license>MIT</license>" in (result.text or "")
    clash = merged(base, mine.replace("0.1.0", "7.7.7"), theirs, MANIFEST)
    assert "7.7.7" in clash.patch
    assert "7.7.7" not in (clash.text or "")


def test_broken_xml_merge_falls_back() -> None:
    base = text(A, path=MANIFEST)
    mine = base.replace("  <name>pkg</name>\n", "  <name>pkg</name>\n  <export>\n")
    result = merged(base, mine, text(A, B, path=MANIFEST), MANIFEST)
    assert result.text == text(A, B, path=MANIFEST)
    assert "+  <export>" in result.patch


def test_retired_file_keeps_everything() -> None:
    base = text(A, B)
    mine = edit(base, "a", "hand = 1\n").replace(
        "__init__()\n", "__init__()\n        self.hand = 0\n"
    )
    result = retire(INPUT, base, mine)
    assert isinstance(result, Merged)
    assert result.text is None
    assert [o.body for o in result.orphans] == ["        hand = 1\n"]
    assert "+        self.hand = 0" in result.patch


def test_a_formatter_makes_no_edits() -> None:
    def formatted(old: str) -> str:
        return old.replace("'", '"').replace(
            "self.a = message.data", "self.a = (\n            message.data\n        )"
        )

    for path in (INPUT, NETWORK):
        base, theirs = text(A, B, path=path), text(C, B, A, version=2, path=path)
        assert formatted(base) != base
        result = merged(base, formatted(base), theirs, path)
        assert result.text is not None
        assert digests_of(path, theirs.encode()).fit(path, result.text.encode())
        assert not result.patch
        mine = edit(formatted(base), "a", "hand = 1  # why\n", path)
        assert "hand = 1  # why" in (merged(base, mine, theirs, path).text or "")


def test_comments_are_edits() -> None:
    base = text(A)
    mine = base.replace("self.a = message.data", "self.a = message.data  # in metres")
    assert "# in metres" in (merged(base, mine, text(A, version=2)).text or "")


def test_file_without_readable_base_is_retired_whole() -> None:
    result = retire(INPUT, "<<<<<<< ours\n", text(A))
    assert isinstance(result, Merged)
    assert "+class EDDIInput" in result.patch


def test_an_old_rename_does_not_catch_another_element() -> None:
    wind = renamed(A, "wind")
    base = text(wind, A)  # another element has the former name now
    result = merged(base, edit(base, "a", "hand = 1\n"), text(wind))
    assert [o.id for o in result.orphans] == ["input:a"]
    assert "hand" not in (result.text or "")


def test_a_rename_may_be_declared_later() -> None:
    z = Element("z")
    gone = merged(text(A), edit(text(A), "a", "hand = 1\n"), text(z))
    back = merged(text(z), gone.text, text(renamed(A, "z")), orphans=gone.orphans)
    assert body(back, "input:z") == "        hand = 1\n"
    assert not any(note.attention for note in back.notes)


def test_a_body_that_comes_back_for_other_inputs_is_looked_at() -> None:
    """As one is whose rename was declared at once."""
    z = Element("z", states=("On", "Off"))
    gone = merged(text(A), edit(text(A), "a", "hand = 1\n"), text(z))
    back = merged(text(z), gone.text, text(replace(z, was=("a",))), orphans=gone.orphans)
    assert [note.attention for note in back.notes] == [False, True]
    assert "was written for other inputs" in back.notes[1].text


def test_a_rename_from_what_never_was_is_told_where_a_body_goes() -> None:
    base, wrong = text(A), Element("z", was=("aa",))
    gone = merged(base, edit(base, "a", "hand = 1\n"), text(wrong))
    assert "'input:z' is to come from 'input:aa', but nothing" in gone.notes[-1].text
    fresh = merged(base, base, text(A, wrong))  # nothing of a person's goes
    assert not fresh.notes


@pytest.mark.parametrize(
    "statement",
    [
        f"x = {'-' * 200_000}1",
        f"x = 1{' + 1' * 500}",
        f"a{'.a' * 500} = 1",
        f"x: a{'.a' * 500} = 1",
        f"f(0x{'f' * 9000})",
        f"from a import b as b{'1' * 9000}",
    ],
    ids=["minus", "sum", "attributes", "annotation", "number", "name"],
)
def test_what_is_too_deep_to_be_merged_is_kept_beside(statement: str) -> None:
    base = text(A, B)
    mine = base.replace("\n\nclass", f"\n{statement}\n\nclass", 1)
    result = merge(INPUT, base, mine, text(A, C, version=2))
    assert isinstance(result, Merged)
    assert statement in f"{result.text}{result.patch}"
