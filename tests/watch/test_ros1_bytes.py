"""Messages of ROS 1 as bytes: read as rosbags reads them, and whatever comes instead."""

from __future__ import annotations

import contextlib
import random
import socket
import struct
import threading
import time
from collections.abc import Callable, Iterator
from types import SimpleNamespace
from typing import Any
from xmlrpc.server import SimpleXMLRPCRequestHandler, SimpleXMLRPCServer

import pytest

pytest.importorskip("rosbags", reason="the extra `bags` is not installed")

from eddi_scaffold.config.message_types import known_messages
from eddi_scaffold.watch.messages import heard
from eddi_scaffold.watch.ros1.connection import Connection
from eddi_scaffold.watch.ros1.decoding import (
    DecodingError,
    decode,
    same_definition,
)
from eddi_scaffold.watch.ros1.source import Ros1Graph
from tests.watch.recorded import built, store_of_ros1, warehouse

CONSERT = "eddi_messages/ConSertStatus"


@pytest.fixture(scope="module")
def store() -> Any:
    return store_of_ros1()


@pytest.fixture(scope="module")
def samples(store: Any) -> dict[str, list[tuple[Any, bytes]]]:
    """Type -> messages and their bytes."""
    found: dict[str, list[tuple[Any, bytes]]] = {}
    for one in warehouse()[::149]:
        of = one.type.replace("/", "/msg/")
        data = bytes(store.serialize_ros1(built(store, one.type, one.content), of))
        found.setdefault(one.type, []).append((one.content, data))
    return found


def same(of: str, ours: Any, theirs: Any) -> bool:
    for field, kind in known_messages()[of].items():
        mine, other = getattr(ours, field), getattr(theirs, field)
        inner = kind.partition("[")[0]
        if inner == "std_msgs/Header":
            continue
        if "/" in inner:
            pairs = zip(mine, other, strict=True) if kind.endswith("]") else [(mine, other)]
            if not all(same(inner, *pair) for pair in pairs):
                return False
        elif inner.startswith("float"):
            if mine != pytest.approx(other, rel=1e-6, nan_ok=True):
                return False
        elif (list(mine) if isinstance(mine, list) else mine) != other:
            return False
    return True


def test_bytes_are_read_as_they_were_written(samples: dict[str, list[tuple[Any, bytes]]]) -> None:
    assert samples.keys() >= heard().keys()
    for of, pairs in samples.items():
        for content, data in pairs:
            assert same(of, decode(of, data), content)


def test_damaged_bytes_are_refused_or_read_and_nothing_else(
    samples: dict[str, list[tuple[Any, bytes]]],
) -> None:
    draw = random.Random(1)
    refused = 0
    for of, pairs in samples.items():
        for _ in range(150):
            data = bytearray(draw.choice(pairs)[1])
            for _ in range(draw.randint(1, 4)):
                at = draw.randrange(len(data))
                match draw.randrange(3):
                    case 0:
                        data[at] = draw.choice((0, 1, 127, 128, 255, draw.randrange(256)))
                    case 1:
                        del data[at : at + draw.randint(1, 9)]
                    case _:
                        data[at:at] = draw.randbytes(draw.randint(1, 9))
                data = data or bytearray(1)
            try:
                decode(of, bytes(data))
            except DecodingError:
                refused += 1
    assert refused > 500
    with pytest.raises(DecodingError):
        decode(CONSERT, b"\xff" * 64)


def definition(store: Any, of: str) -> str:
    text: str = store.generate_msgdef(of.replace("/", "/msg/"), ros_version=1)[0]
    return text


def test_a_definition_is_compared_with_all_its_parts(store: Any) -> None:
    for of in heard():
        text = definition(store, of)
        assert same_definition(of, text)
        last = text.rstrip("\n").rpartition("\n")[2]
        kind, _, name = last.partition(" ")
        assert not same_definition(of, text.replace(last, f"{kind} other_{name}"))
    assert not same_definition(CONSERT, "")
    assert not same_definition(CONSERT, "=" * 80 + "\nMSG: x\n" * 3)


@contextlib.contextmanager
def pair() -> Iterator[tuple[socket.socket, Connection]]:
    ours, theirs = socket.socketpair()
    ours.setblocking(False)
    with ours, theirs:
        yield theirs, Connection("/t", "/n", CONSERT, ours, {"latching": "1"})


def test_pieces_of_messages_and_equal_ones(samples: dict[str, list[tuple[Any, bytes]]]) -> None:
    data = samples[CONSERT][0][1]
    frame = struct.pack("<I", len(data)) + data
    later = struct.pack("<I", len(data)) + b"\7" * 12 + data[12:]  # another stamp
    with pair() as (theirs, one):
        theirs.sendall(frame[:3])
        assert list(one.read()) == []
        theirs.sendall(frame[3:20])
        assert list(one.read()) == []
        theirs.sendall(frame[20:] + later + frame[:9])
        (first, kept), (second, fresh) = one.read()
        assert (kept, fresh) == (True, False)
        assert first is second
        assert first.model_id == "warehouse"


@pytest.mark.parametrize("bad", [b"\xff\xff\xff\xff1", struct.pack("<I", 8) + b"\xff" * 8, b""])
def test_what_is_no_message_ends_the_connection(bad: bytes) -> None:
    with pair() as (theirs, one):
        if bad:
            theirs.sendall(bad)
        else:
            theirs.close()
        with pytest.raises((OSError, DecodingError)):
            list(one.read())


class Handler(SimpleXMLRPCRequestHandler):
    def log_message(self, *_: Any) -> None: ...


@contextlib.contextmanager
def master(**answers: Callable[..., Any]) -> Iterator[str]:
    """A server that answers as a master and as a node, or what neither would."""
    with SimpleXMLRPCServer(("127.0.0.1", 0), Handler, allow_none=True) as server:
        for name, answer in answers.items():
            server.register_function(answer, name)
        thread = threading.Thread(target=server.serve_forever, args=(0.02,), daemon=True)
        thread.start()
        yield f"http://127.0.0.1:{server.server_address[1]}"
        server.shutdown()
        thread.join()


@contextlib.contextmanager
def publisher(*blocks: bytes) -> Iterator[int]:
    """A publisher that answers every connection with some bytes."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        stop = threading.Event()

        def serve() -> None:
            held = []
            while not stop.is_set():
                with contextlib.suppress(OSError):
                    made, _ = server.accept()
                    held.append(made)
                    made.recv(4096)
                    for block in blocks:
                        made.sendall(block)
            for one in held:
                one.close()

        thread = threading.Thread(target=serve, daemon=True)
        thread.start()
        yield server.getsockname()[1]
        stop.set()
        with contextlib.suppress(OSError):
            socket.create_connection(server.getsockname(), 1).close()
        thread.join(5)


def head(**fields: str) -> bytes:
    lines = [f"{k}={v}".encode() for k, v in fields.items()]
    body = b"".join(struct.pack("<I", len(line)) + line for line in lines)
    return struct.pack("<I", len(body)) + body


def noted(graph: Ros1Graph, words: str) -> bool:
    end = time.monotonic() + 10.0
    while time.monotonic() < end:
        graph.receive(0.05)
        if any(words in note for note in graph.notes()):
            return True
    raise AssertionError((words, graph.notes()))


def world(port: int) -> SimpleNamespace:
    """The answers of a master with one node, whose topic is at a port."""
    state = [[["/r/c/g/status", ["/r/c"]]], [], []]
    return SimpleNamespace(
        getSystemState=lambda _: [1, "", state],
        getTopicTypes=lambda _: [1, "", [["/r/c/g/status", CONSERT]]],
        requestTopic=lambda *_: [1, "", ["TCPROS", "127.0.0.1", port]],
    )


@pytest.mark.parametrize(
    ("sent", "words"),
    [
        (head(error="go away"), "go away"),
        (head(type="std_msgs/Bool", message_definition="bool data"), "sends std_msgs/Bool"),
        (head(type=CONSERT, message_definition="string id"), "another definition"),
        (struct.pack("<I", 1 << 30), "a head of"),
        (struct.pack("<I", 9) + b"\xff" * 9, "sends None"),
    ],
)
def test_a_publisher_that_is_none_is_named(sent: bytes, words: str) -> None:
    with publisher(sent) as port:
        parts = vars(world(port))
        uri: list[str] = []
        parts["lookupNode"] = lambda *_: [1, "", uri[0]]
        with master(**parts) as found:
            uri.append(found)
            with contextlib.closing(Ros1Graph(found)) as graph:
                assert noted(graph, words)


def test_messages_come_and_nonsense_behind_them_is_named(
    store: Any, samples: dict[str, list[tuple[Any, bytes]]]
) -> None:
    data = samples[CONSERT][0][1]
    frame = struct.pack("<I", len(data)) + data
    text = definition(store, CONSERT)
    good = head(type=CONSERT, message_definition=text, latching="0")
    with publisher(good, frame, struct.pack("<I", 5) + b"\xff" * 5) as port:
        parts = vars(world(port))
        uri: list[str] = []
        parts["lookupNode"] = lambda *_: [1, "", uri[0]]
        with master(**parts) as found:
            uri.append(found)
            with contextlib.closing(Ros1Graph(found)) as graph:
                end, came = time.monotonic() + 10.0, []
                while not came and time.monotonic() < end:
                    came += graph.receive(0.05)[1]
                assert came[0].content.model_id == "warehouse"
                assert noted(graph, "/r/c/g/status of /r/c: ")


@pytest.mark.parametrize(
    "answer", [[1, "", "nonsense"], [1, "", []], [1, "", [[[1]], 2]], 7, [0, "no", 0]]
)
def test_a_master_that_answers_nonsense_is_named(answer: Any) -> None:
    types = [1, "", [["/a"]]]
    with (
        master(getSystemState=lambda _: answer, getTopicTypes=lambda _: types) as uri,
        contextlib.closing(Ros1Graph(uri)) as graph,
    ):
        assert noted(graph, "the ROS master")


def test_without_a_master_it_waits_and_says_so() -> None:
    with contextlib.closing(Ros1Graph("http://127.0.0.1:1")) as graph:
        assert noted(graph, "the ROS master does not answer")
