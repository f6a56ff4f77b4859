"""Damage to the bytes of a file, as hypothesis strategies that shrink."""

import re

from hypothesis import strategies as st

TOKEN = re.compile(rb"[A-Za-z0-9_.]+|[^\sA-Za-z0-9_.]+")
NASTY = [
    *(b"", b"\0", b"\xff", b"\xed\xa0\x80", b"\xef\xbb\xbf", b"\r", b"\t", b"\x1b[31m", b"\x85"),
    *(b"&#0;", b"&#xD800;", b"&amp;", b"&x;", b"]]>", b"<![CDATA[", b"<!--", b"<?x?>", b"</"),
    *(b"<!DOCTYPE x [<!ENTITY x 'y'>]>", b"//@odeProductPackages.0", b"//@odeProductPackages.9"),
    *(b"xsi:type", b"href", b"consert_:NumericDimension", b"AND", b"OR", b"xmlns:consert_"),
    *(b"1e999", b".nan", b".inf", b"-1", b"0", b"1_000", b"99999999999999999999", b"1e-400"),
    *(b"*a", b"&a [*a]", b"!!python/object/apply:os.system", b"<<", b"?", b"|", b">", b"%", b"="),
    *(b"null", b"true", b"off", b"{}", b"[]", b"[", b"]", b"{", b"}", b": ", b"- ", b"#", b"---\n"),
    *(b"'''", b'"""', b"'", b'"', b"\\", b"{{ 7*7 }}", b"{% raw %}", b"$(arg x)", b"../../x", b"/"),
    *("\u2028".encode(), "ü💥".encode(), b" " * 40, b"\n" * 3, b"\n  ", b"a" * 5000),
]  # fmt: skip

PLACES = st.integers(0, 1_000_000)
OPERATIONS = st.one_of(
    st.tuples(st.just("flip"), PLACES, st.integers(0, 255)),
    st.tuples(st.just("cut"), PLACES, st.integers(1, 60)),
    st.tuples(st.just("insert"), PLACES, st.one_of(st.sampled_from(NASTY), st.binary(max_size=8))),
    st.tuples(st.just("swap"), PLACES, PLACES),
    st.tuples(st.just("replace"), PLACES, st.one_of(st.sampled_from(NASTY), PLACES)),
    st.tuples(st.just("repeat line"), PLACES, st.integers(1, 3)),
    st.tuples(st.just("end"), PLACES, st.none()),
)


def mutations(data: bytes) -> st.SearchStrategy[bytes]:
    """Return the bytes with one to five mutations."""
    return st.lists(OPERATIONS, min_size=1, max_size=5).map(lambda done: mutated(data, done))


def mutated(data: bytes, operations: list[tuple[str, int, object]]) -> bytes:
    for name, place, how in operations:
        if data:
            data = _one(data, name, place, how)
    return data


def _one(data: bytes, name: str, place: int, how: object) -> bytes:
    at = place % len(data)
    if name == "flip":
        return data[:at] + bytes([how]) + data[at + 1 :]
    if name == "cut":
        return data[:at] + data[at + how :]
    if name == "insert":
        return data[:at] + how + data[at:]
    if name == "end":
        return data[:at]
    if name == "repeat line":
        lines = data.splitlines(keepends=True)
        line = place % len(lines)
        return b"".join([*lines[: line + 1], *[lines[line]] * how, *lines[line + 1 :]])
    tokens = list(TOKEN.finditer(data))
    if not tokens:
        return data
    first = tokens[place % len(tokens)]
    if name == "replace":
        new = how if isinstance(how, bytes) else tokens[how % len(tokens)].group()
        return data[: first.start()] + new + data[first.end() :]
    second = tokens[how % len(tokens)]
    one, two = sorted([first, second], key=lambda token: token.start())
    if one is two:
        return data
    middle = data[one.end() : two.start()]
    return data[: one.start()] + two.group() + middle + one.group() + data[two.end() :]
