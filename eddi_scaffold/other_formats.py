"""Files of other tools that are given in place of ours, known by their first bytes."""

from __future__ import annotations

import re

HEAD_BYTES = 4096
_NETWORK = "save it as XDSL, XMLBIF 0.3 or BIF"
_BY_GENIE = f"GeNIe opens it: {_NETWORK}"
_FORMATS = (
    (rb"\Aversion https://git-lfs\.", "a pointer of Git LFS, not the file", "run `git lfs pull`"),
    (rb"\A\x1f\x8b", "compressed by gzip", "unpack it with `gunzip`"),
    (rb"\APK\x03\x04", "a zip archive", "unpack it, and name the file in it"),
    (rb"\A\s*(?://[^\n]*\n\s*)*(?://\s*~->\[DNET-1\]|bnet\b)", "a network of Netica", _BY_GENIE),
    (rb"\A\s*belief\s+network\b", "a network of MSBN", _BY_GENIE),
    (rb"<ANALYSISNOTEBOOK\b", "a network of MSBN", _BY_GENIE),
    (rb"\A(?:\s|%[^\n]*\n)*(?:net|class\s+\w+)\s*\{", "a network of Hugin", _BY_GENIE),
    (rb"<ProbModelXML\b", "a network of OpenMarkov", _NETWORK),
    (
        rb"""<(?i:(?:\w+:)?bif\b[^>]*\bversion\s*=\s*["']0\.[45])""",
        "XMLBIF 0.4 or 0.5, which writes networks in another way",
        "save it as XMLBIF 0.3 or BIF, for example with JavaBayes",
    ),
)


def other_format(head: bytes) -> tuple[str, str] | None:
    """Return what a file is and what to do about it, ``None`` for one that may be ours."""
    text = head.removeprefix(b"\xef\xbb\xbf")
    return next(((name, hint) for form, name, hint in _FORMATS if re.search(form, text)), None)
