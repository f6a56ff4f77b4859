"""Loading: what is refused, how it is said, and that no file whatever ends in a traceback."""

import pytest

from tests.eddi_xml.eddi_texts import ROVER, codes, parsed, read, texts

BOM = b"\xef\xbb\xbf"


MISMATCH = "Opening and ending tag mismatch: "
START = "Start tag expected, '<' not found"
BROKEN = [
    (b"<a>\n  <b>\n  </d>\n</a>", 3, f"{MISMATCH}b line 2 and d"),
    (b"<a>\n  <b/>\n", 3, "Premature end of data in tag a line 1"),
    (b'<!-- c -->\n<?xml version="1.0"?>\n<a/>', 2, "XML declaration allowed only"),
    (b"<!-- c -->\n" + BOM + b'<?xml version="1.0"?>\n<a/>', 2, START),
    # the parser warns of the name first
    (b'<a xmlns="drone">\n  <b/>\n</c>', 3, f"{MISMATCH}a line 1 and c"),
    (b"", 1, "Document is empty"),
    (b"guarantees: []\n", 1, START),
    (b'<a b="1" b="2"/>', 1, "Attribute b redefined"),
    (b'<?xml version="1.0" encoding="ASCII"?><a b="\xc3\xa9"/>', 1, "Invalid bytes"),
]


@pytest.mark.parametrize(("data", "line", "reason"), BROKEN)
def test_not_well_formed(data: bytes, line: int, reason: str) -> None:
    (problem,) = read(data)[1]
    assert (problem.code, problem.level, problem.place.line) == ("X001", "error", line)
    assert problem.message.startswith(f"not well-formed: {reason}")
    assert problem.place.col is not None


@pytest.mark.parametrize("value", ['"Arm/>\n<c/>', "'Arm/>\n</a>", '"Arm/>\n'])
def test_a_quote_that_is_not_closed_is_told_where_it_stands(value: str) -> None:
    _, problems = read(f'<a xmlns="drone">\n  <b name={value}</a>'.encode())
    assert [(one.code, one.place.line) for one in problems] == [("X001", 2)]
    assert problems[0].hint == "close the quote; a `<` in a value is `&lt;`"


def _entities(count: int) -> str:
    names = "".join(
        f'<!ENTITY e{i} "{f"&e{i - 1};" * 10 if i else "x" * 1000}">' for i in range(count)
    )
    return f"<!DOCTYPE r [{names}]>"


DOCTYPES = {
    "external entity in text": '<!DOCTYPE r [<!ENTITY x SYSTEM "file:///etc/passwd">]><r>&x;</r>',
    "external entity in an attribute": '<!DOCTYPE r [<!ENTITY x "boo">]><r a="&x;"/>',
    "parameter entity": '<!DOCTYPE r [<!ENTITY % x SYSTEM "http://localhost:1/x.dtd"> %x;]><r/>',
    "external DTD": '<!DOCTYPE r SYSTEM "http://localhost:1/x.dtd"><r/>',
    "empty DOCTYPE": "<!DOCTYPE r><r/>",
    "DOCTYPE behind a comment": "<!-- c --><?p i?>\n<!DOCTYPE r><r/>",
    "billion laughs in text": f"{_entities(12)}<r>&e11;</r>",
    "billion laughs in an attribute": f'{_entities(12)}<r a="&e11;"/>',
    "quadratic blow-up": f'<!DOCTYPE r [<!ENTITY x "{"y" * 50_000}">]><r>{"&x;" * 5000}</r>',
}
LARGE = {
    "depth": "<a>" * 5000 + "</a>" * 5000,
    "long attribute": f'<a b="{"x" * 10_500_000}"/>',
    "long text": f"<a>{'x' * 10_500_000}</a>",
    "many attributes": "<a><b " + " ".join(f"a{i}=''" for i in range(2000)) + "/></a>",
}


@pytest.mark.parametrize("name", [*DOCTYPES, "DOCTYPE in UTF-16", *LARGE])
def test_attacks_are_refused(name: str) -> None:
    text = {**DOCTYPES, **LARGE}.get(name, DOCTYPES["empty DOCTYPE"])
    (problem,) = read(text.encode("utf-16" if "UTF-16" in name else "utf-8"))[1]
    assert (problem.code, problem.level) == ("X003" if name in LARGE else "X001", "error")
    assert problem.place.line is not None


def test_a_doctype_far_behind_is_refused_after_parsing() -> None:
    data = b"<!--" + b"x" * 100_000 + b"-->\n<!DOCTYPE r><r/>"
    assert [p.code for p in read(data)[1]] == ["X001"]


def test_xinclude_is_not_followed() -> None:
    data = (
        b'<a xmlns:xi="http://www.w3.org/2001/XInclude"><xi:include href="/etc/passwd" '
        b'parse="text"/></a>'
    )
    document, problems = parsed(data)
    assert problems == []
    assert not list(document.roots[0].itertext())


def test_limits_name_value_and_limit() -> None:
    data = b"<r>\n<b " + b" ".join(b'a%d="1"' % i for i in range(1001)) + b"/></r>"
    assert texts(read(data)[1]) == [
        "m.xml:2: error X003: the number of attributes is 1001, more than the limit of 1000"
    ]
    fewer = b"<r>\n<b " + b" ".join(b'a%d="1"' % i for i in range(1000)) + b"/></r>"
    assert read(fewer)[1] == []


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "ascii"])
def test_encodings_and_byte_order_marks(encoding: str) -> None:
    name = encoding.removesuffix("-sig").upper()
    data = ROVER.replace("UTF-8", name, 1).encode(encoding)
    conserts, problems = read(data)
    assert problems == []
    assert conserts == read(ROVER)[0]


def test_undeclared_prefixes_are_declared() -> None:
    text = "<!-- c -->\n<p:r>\n<q:a x:type='q:T' y='1'/>\n<x:b/></p:r>"
    document, problems = parsed(text)
    assert sorted(texts(problems)) == [
        'm.xml:2: warning X006: the prefix "p" is not declared; it is read as if it were',
        'm.xml:2: warning X006: the prefix "q" is not declared; it is read as if it were',
        'm.xml:2: warning X006: the prefix "x" is not declared; it is read as if it were',
    ]
    assert document.class_of(document.roots[0]).package == "p"
    assert [document.place(child).line for child in document.roots[0]] == [3, 4]


def test_a_warning_of_the_parser_does_not_forbid_undeclared_prefixes() -> None:
    _, problems = parsed(b'<r xmlns="drone">\n<p:a/></r>')
    assert codes(problems) == {"X006"}


def test_undeclared_xsi_and_xmi_are_the_well_known_ones() -> None:
    text = ROVER.replace(' xmlns:xmi="http://www.omg.org/XMI"', "").replace(
        ' xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"', ""
    )
    conserts, problems = read(text)
    assert codes(problems) == {"X006"}
    assert conserts == read(ROVER)[0]


def test_undeclared_prefixes_do_not_hide_an_error_behind_them() -> None:
    # libxml2 stops to record errors after 100; trusting its log would accept this file.
    many = "".join(f"<p{i}:a/>" for i in range(150))
    _, problems = read(f"<r>{many}\n</s>")
    assert texts(problems) == [
        "m.xml:2: error X001: not well-formed: Opening and ending tag mismatch: r line 1 and s"
    ]


def test_a_prefix_in_a_type_only_is_no_error() -> None:
    text = ROVER.replace(' xmlns:consert_="http://www.deis-project.eu/ode/consert"', "")
    assert read(text) == read(ROVER)


def test_lines_beyond_65535() -> None:
    text = "<r>\n" + "<a/>\n" * 70_000 + "<b>\n<c/><d>\n\n<e/>\n</d>\n</b>\n</r>"
    document, _ = parsed(text)
    first, *_, last = document.roots[0]
    assert (document.place(first).line, document.place(last).line) == (2, None)
