"""A page that shows what a test lets two robots publish."""

from collections.abc import Iterator
from contextlib import contextmanager
from types import SimpleNamespace

from eddi_scaffold.watch.fleet import FleetState
from eddi_scaffold.watch.messages import DIAGNOSTICS, DIAGNOSTICS_TOPIC, Message
from eddi_scaffold.watch.page import Feed, View, open_server
from tests.pages import served
from tests.watch.recorded import warehouse


class Fleet:
    """Two robots, as far as the test lets time pass."""

    def __init__(self) -> None:
        self.state = FleetState()
        self.now = 0.0
        self.feed = Feed(View(self.state.snapshot(0.0), "{:10.3f}".format))

    def play(self, until: float, robots: tuple[str, ...] = ("/robot1", "/robot2")) -> None:
        for one in warehouse():
            if self.now < one.t <= until:
                for robot in robots:
                    node = f"{robot}/{one.node}"
                    self.take(Message(f"{robot}{one.topic}", one.type, one.content, one.t, node))
        self.now = until
        self.show()

    def take(self, message: Message) -> None:
        self.state.look(message.t)
        self.state.take(message)

    def show(self) -> None:
        self.state.look(self.now)
        self.feed.show(View(self.state.snapshot(self.now), "{:10.3f}".format))


def diagnostics(t: float, node: str, **values: str) -> Message:
    pairs = {"runtime_version": "1", **{k.replace("__", "."): v for k, v in values.items()}}
    status = SimpleNamespace(
        name=f"{node.strip('/')}: Robot",
        hardware_id=node,
        message="well",
        values=[SimpleNamespace(key=k, value=v) for k, v in pairs.items()],
    )
    return Message(DIAGNOSTICS_TOPIC, DIAGNOSTICS, SimpleNamespace(status=[status]), t)


@contextmanager
def serving(fleet: Fleet) -> Iterator[int]:
    with served(open_server(0, fleet.feed)) as port:
        yield port
