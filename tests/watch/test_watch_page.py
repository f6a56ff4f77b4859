"""The page of a fleet over HTTP: what it shows, what it sends on, what it refuses."""

import http.client
import json
import xml.etree.ElementTree as ET
from types import SimpleNamespace

import pytest

from eddi_scaffold.cli.watch import pictures_of
from eddi_scaffold.diagrams import Diagram, DiagramNode
from eddi_scaffold.watch.messages import Message
from eddi_scaffold.watch.page import verdict_graph
from tests.pages import ask
from tests.watch.recorded import ROBOT
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
        assert {"FullSpeed", "PathClear", "unknown", "/robot2"} <= {*words}
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


def test_streams_leave_room_for_pages() -> None:
    with serving(Fleet(), connections=4) as port:
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


def words_of(picture: str) -> list[str]:
    root = ET.fromstring(picture)
    return [node.text or "" for node in root.iter("{http://www.w3.org/2000/svg}text")]


def test_a_known_model_is_drawn_with_its_states() -> None:
    fleet = Fleet()
    fleet.play(13.0)
    robot = fleet.feed.view.snapshot.robots[0]
    known = words_of(verdict_graph(robot, pictures_of([ROBOT / "warehouse.yml"])))
    assert known.count("AND") == 0
    at = known.index("lacks")
    assert known[at - 1] == "PathClear"  # evidence of the model
    assert "AND" not in words_of(verdict_graph(robot, {}))
    ((title, _),) = pictures_of([ROBOT / "warehouse.yml"])
    other = Diagram("warehouse", (DiagramNode("FullSpeed", ("FullSpeed",)),))
    assert "WalkingPace" in words_of(verdict_graph(robot, {(title, "warehouse"): other}))


def test_models_may_be_named_by_configurations_and_deployment_files() -> None:
    assert {name for _, name in pictures_of([ROBOT / "robot.yml"])} >= {"warehouse"}
    of_two = pictures_of([ROBOT.parent / "two-robots" / "deployment.yml"])
    assert {name.lower() for _, name in of_two} >= {"arm", "cart"}


def test_reasons_are_told_with_topics_where_the_node_reports_them() -> None:
    fleet = Fleet()
    fleet.play(13.0)
    late = "nearest: /scan is late, 0.9 s old, the limit is 0.5 s"
    values = {"event__PathClear": f"inactive: {late}", "guarantee__StandStill": "inactive: x"}
    fleet.take(diagnostics(13.0, "/robot1/lidar", **values))
    fleet.take(diagnostics(13.0, "/robot1/warehouse", **values))
    fleet.show()
    shown, _, _ = fleet.feed.view.page.partition('id="r1"')
    assert f"<td>{late}</td>" in shown
    assert "<td>x</td>" not in shown  # StandStill is active by now
