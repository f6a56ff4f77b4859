"""The page of a fleet over HTTP: what it shows, what it sends on, what it refuses."""

import http.client
import json
import xml.etree.ElementTree as ET
from types import SimpleNamespace

import pytest

from eddi_scaffold.watch import page
from eddi_scaffold.watch.messages import Message
from tests.pages import ask
from tests.watch.served import Fleet, diagnostics, serving


def event(stream: http.client.HTTPResponse) -> str:
    while True:
        line = stream.readline().decode()
        assert line, "the stream has ended"
        if line.startswith("data: "):
            return str(json.loads(line.removeprefix("data: ")))


def test_the_page_shows_every_verdict_and_loads_nothing_from_elsewhere() -> None:
    fleet = Fleet()
    fleet.play(13.0)
    with serving(fleet) as port:
        status, headers, text = ask(port, "/")
        assert status == 200
        assert headers["Content-Security-Policy"].startswith("default-src 'none'; style-src 'self'")
        assert "http:" not in text
        assert text.count('<th scope="row">FullSpeed</th>') == 2
        assert "<td>PathClear</td><td>12.300</td>" in text
        assert "6 active, 0 not active, 3 unknown" in text
        for path in ("/style.css", "/page.js"):
            assert ask(port, path)[0] == 200
        picture = ask(port, "/graph/1.svg?5")[2]
        root = ET.fromstring(picture)
        words = [node.text for node in root.iter("{http://www.w3.org/2000/svg}text")]
        assert {"FullSpeed", "PathClear", "unknown", "Robot /robot2"} <= {*words}
        scan = {"nearest": "stale", "nearest__age_s": "0.9", "nearest__from": "/lidar/nearest"}
        fleet.take(diagnostics(13.0, "/robot2/lidar", **scan))
        fleet.show()
        assert ">/lidar/nearest<" in ask(port, "/graph/1.svg")[2]
        for path in ("/graph/2.svg", "/graph/-1.svg", "/x", "/../server.py", "/graph/99999999.svg"):
            assert ask(port, path)[0] == 404
        assert ask(port, "/", "POST")[0] == 404


def test_events_bring_what_is_new() -> None:
    fleet = Fleet()
    fleet.play(12.0)
    with serving(fleet) as port:
        connection = http.client.HTTPConnection("127.0.0.1", port, timeout=10)
        connection.request("GET", "/events")
        stream = connection.getresponse()
        assert stream.headers["Content-Type"] == "text/event-stream"
        assert event(stream).count("data-state=") == 18
        fleet.play(13.0)
        second = event(stream)
        assert second == ask(port, "/")[2]
        assert "/robot2 lidar PathClear is unknown" in second
        fleet.play(17.0, robots=("/robot1",))
        assert event(stream).count("<td>no message for more than 3 s") == 9
        connection.close()


@pytest.mark.parametrize("path", ["/", "/events", "/graph/0.svg"])
def test_only_this_machine_by_its_name_is_answered(path: str) -> None:
    with serving(Fleet()) as port:
        for host in ("evil.example", "localhost", f"x:{port}", "127.0.0.1"):
            assert ask(port, path, Host=host)[0] == 403
        assert ask(port, path, Origin="http://evil.example")[0] == 403


def test_streams_have_an_end(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(page, "STREAMS", 2)
    with serving(Fleet()) as port:
        open_ones = [http.client.HTTPConnection("127.0.0.1", port, timeout=10) for _ in range(2)]
        for one in open_ones:
            one.request("GET", "/events")
            assert one.getresponse().status == 200
        assert ask(port, "/events")[0] == 503
        assert ask(port, "/")[0] == 200
        for one in open_ones:
            one.close()


def test_what_a_robot_sends_is_never_markup() -> None:
    attack = "</td><script>alert(1)</script>\"'<img src=x onerror=alert(1)>\n\ndata: {}"
    rows = [SimpleNamespace(id=attack, verdict=1, missing=[attack])]
    content = SimpleNamespace(
        model_id=attack, model_digest=attack, guarantees=rows, accepted=[attack]
    )
    fleet = Fleet()
    fleet.take(Message(f"/{attack}/a/b", "eddi_messages/ConSertStatus", content, 0.0, attack))
    fleet.take(Message("/a/b/c", "eddi_messages/ConSertStatus", SimpleNamespace(x=attack), 0.0))
    fleet.show()
    with serving(fleet) as port:
        text = ask(port, "/")[2]
        assert "<script>" not in text
        assert "<img src=x" not in text
        picture = ask(port, "/graph/0.svg")[2]
        assert "<script" not in picture
        ET.fromstring(picture)
        connection = http.client.HTTPConnection("127.0.0.1", port, timeout=10)
        connection.request("GET", "/events")
        assert event(connection.getresponse()) == text
        connection.close()
