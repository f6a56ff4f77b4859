"""Files: read once, only regular ones and with a limit; those of other tools are named.

FIFOs, sockets and devices may wait for ever, or be read without end.
"""

from __future__ import annotations

import errno
import hashlib
import os
import re
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path, PurePosixPath
from typing import BinaryIO

from eddi_scaffold.common.problems import EddiError, Place, problem

MAX_BYTES = 64 * 1024 * 1024  # a larger file is nothing that we read


_KINDS = {stat.S_IFIFO: "a FIFO", stat.S_IFSOCK: "a socket"}


class NotRegularError(OSError):
    """The entry is a FIFO, a socket or a device."""


def open_regular(path: str | Path) -> BinaryIO:
    """Open a file, or what a link leads to, for reading; the caller closes it.

    Raises:
        NotRegularError: it is not a regular file; nothing waits for its other end.
        OSError: it is a folder, or cannot be opened.
    """
    if "\0" in str(path):
        raise OSError(errno.EINVAL, "no file has such a name")
    _refuse(Path(path).stat().st_mode, path)
    handle = os.open(path, os.O_RDONLY | os.O_CLOEXEC | os.O_NONBLOCK)
    try:
        _refuse(os.fstat(handle).st_mode, path)  # another one may be there by now
    except OSError:
        os.close(handle)
        raise
    return os.fdopen(handle, "rb")


def read_regular(path: str | Path, limit: int = MAX_BYTES) -> bytes:
    """Return the bytes of a regular file, of which no more than ``limit`` + 1 are read.

    Raises:
        NotRegularError: it is not a regular file.
        OSError: it is a folder, cannot be read, or is larger than ``limit``.
    """
    with open_regular(path) as stream:
        data = stream.read(limit + 1) or b""  # None: nothing new in kmsg
    if len(data) > limit:
        reason = f"it has more than the limit of {limit} bytes"
        raise OSError(errno.EFBIG, reason, str(path))
    return data


def _refuse(mode: int, path: str | Path) -> None:
    kind = stat.S_IFMT(mode)
    if kind == stat.S_IFDIR:
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    if kind != stat.S_IFREG:
        reason = f"it is {_KINDS.get(kind, 'a device')}, and only regular files are read"
        raise NotRegularError(errno.EINVAL, reason, str(path))


HEAD_BYTES = 4096
_NETWORK = "save it as XDSL, XMLBIF 0.3 or BIF"
_BY_GENIE = f"GeNIe opens it: {_NETWORK}"
IMPORT = "import it in EDDI-Editor, and name the file that it saves"
_FORMATS = (
    (rb"\Aversion https://git-lfs\.", "a pointer of Git LFS, not the file", "run `git lfs pull`"),
    (rb"\A\x1f\x8b", "compressed by gzip", "unpack it with `gunzip`"),
    (rb"(?s)\APK\x03\x04.{26}project\.json", "a project of Dymodia", IMPORT),
    (rb'\A\s*\{\s*"format"\s*:\s*"StateMachine"', "a state machine of Dymodia", IMPORT),
    (rb"<HiP-HOPS_Results\b", "a file of results of HiP-HOPS", IMPORT),
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


_inputs: ContextVar[set[tuple[int, int]] | None] = ContextVar("_inputs", default=None)
"""Device and number of the files that the command has read; ``None`` where nobody asks."""


@dataclass(frozen=True)
class Source:
    """One input file."""

    name: str  # path as the user gave it, for messages
    data: bytes
    # what describes a model in it: the rest may change, and the part move, without a word
    part: bytes | None = None

    @cached_property
    def sha256(self) -> str:
        """Hex digest of the part, else of the bytes, for traceability."""
        return hashlib.sha256(self.data if self.part is None else self.part).hexdigest()

    def text(self, code: str) -> str:
        """Return the content as text, without a byte order mark; ``code`` is that of the problem.

        Raises:
            EddiError: it is not UTF-8 text; the place is that of the first byte that is wrong.
        """
        try:
            return self.data.decode("utf-8-sig")
        except UnicodeDecodeError as failure:
            *above, line = self.data[: failure.start].decode("utf-8", "replace").split("\n")
            place = Place(self.name, len(above) + 1, len(line) + 1)
            raise EddiError(problem(f"{code}.encoding", place)) from None

    @property
    def stem(self) -> str:
        """File name without folder and suffix."""
        return Path(self.name).stem

    @property
    def file_name(self) -> str:
        """File name without folder: what a generated file may mention."""
        return Path(self.name).name


def next_to(file: str, name: str) -> Path:
    """Return where a file is that another one names, in its folder or below (EddiError, F009)."""
    root, path = Path(file).parent, PurePosixPath(name)
    folders = [root / folder for folder in path.parents][:-1]
    is_below = name.isprintable() and path.name and ".." not in path.parts
    if not is_below or path.is_absolute() or any(map(os.path.islink, folders)):
        raise EddiError(problem("F009.outside", Place(file)))
    return root / path


def read_source(path: str | Path, limit: int = MAX_BYTES) -> Source:
    """Read a file, and nothing that would wait or never end.

    Raises:
        EddiError: the file is missing, unreadable, no regular file (a folder, pipe or device), or
            larger than ``limit`` bytes (F001); it is of another format (F003).
    """
    try:
        with open_regular(path) as stream:
            note_input(stream.fileno())
        data = read_regular(path, limit)
    except OSError as failure:
        hint = "write it to a file first" if isinstance(failure, NotRegularError) else None
        fields = {"reason": failure.strerror or str(failure)}
        raise EddiError(problem("F001.unreadable", Place(str(path)), hint=hint, **fields)) from None
    other = other_format(data[:HEAD_BYTES])
    if other is not None:
        raise EddiError(problem("F003.other", Place(str(path)), hint=other[1], other=other[0]))
    return Source(str(path), data)


@contextmanager
def inputs_noted() -> Iterator[None]:
    """Note the files that are read meanwhile: a command does not write over its own inputs."""
    token = _inputs.set(set())
    try:
        yield
    finally:
        _inputs.reset(token)


def note_input(file: int) -> None:
    """Note an open file as an input, whatever names it has."""
    noted = _inputs.get()
    if noted is not None:
        noted.add(_identity(os.fstat(file)))


def refuse_input(path: Path) -> None:
    """Refuse an output file that this command has read (EddiError, F014)."""
    try:
        identity = _identity(path.stat())
    except OSError:  # nothing there: it is new
        return
    if identity in (_inputs.get() or ()):
        raise EddiError(problem("F014", Place(str(path))))


def saved_meanwhile(path: Path) -> EddiError:
    """Return what to say of a file that was saved between its reading and its writing (F013)."""
    return EddiError(problem("F013", Place(str(path))))


def _identity(status: os.stat_result) -> tuple[int, int]:
    return status.st_dev, status.st_ino
