"""``eddi-scaffold watch``: which guarantees of a fleet are active, and why the others are not."""

from __future__ import annotations

import json
import os
import threading
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from eddi_scaffold.cli.console import console
from eddi_scaffold.cli.options import Domains
from eddi_scaffold.common.problems import EddiError, problem

if TYPE_CHECKING:
    from eddi_scaffold.watch.fleet import FleetState
    from eddi_scaffold.watch.following import Clock
    from eddi_scaffold.watch.messages import Source

_MASTER = "http://localhost:11311"


def watch(
    bag: Path | None = None,
    master: str | None = None,
    domain: Domains = None,
    robot: list[str] | None = None,
    patience: Annotated[float, typer.Option("--patience", min=0.1)] = 3.0,
    text: bool = False,
    as_json: bool = False,
    port: Annotated[int, typer.Option("--port", min=0, max=65535)] = 0,
    speed: Annotated[float, typer.Option("--speed", min=0.01)] = 1.0,
) -> None:
    """Watch which guarantees of robots are active.

    Says why the others are not, and since when. Shows a page on this machine; with --text,
    prints a line for each change.

    Example: eddi-scaffold watch --text --robot arm

    Args:
        bag: ROS 1 or 2 bag in which monitors' messages were recorded.
        master: ROS 1 master; by default ROS_MASTER_URI, else http://localhost:11311.
        domain: ROS 2 domain, read over DDS; by default ROS_DOMAIN_ID where there is no
            ROS_MASTER_URI. May be repeated.
        robot: NAME or NAME=/namespace of a robot to watch; may be repeated.
        patience: Seconds of silence that make a verdict unknown.
        text: Print a line for each change.
        port: Of the page; 0 for any free one.
        speed: How fast the page plays a recording.
    """
    from eddi_scaffold.watch.fleet import FleetState
    from eddi_scaffold.watch.following import changes, document, line
    from eddi_scaffold.watch.messages import requested_robots

    state = FleetState(requested_robots(robot or ()), patience)
    source, clock = opened(bag, master, domain, None if text or as_json else speed)
    try:
        if not (text or as_json):
            _serve(source, state, clock, port)
            return
        for change in changes(source, state, console.say):
            data = json.dumps(document(change, clock)) if as_json else line(change, clock)
            console.data(data)
    finally:
        source.close()


def opened(
    bag: Path | None, master: str | None, domains: list[int] | None, speed: float | None
) -> tuple[Source, Clock]:
    """Return the source that is asked for, and what writes its times."""
    from eddi_scaffold.watch.following import time_of_day
    from eddi_scaffold.watch.recording import Recording
    from eddi_scaffold.watch.ros1 import Ros1Graph

    options = {"--bag": bag, "--master": master, "--domain": domains}
    names = [name for name, value in options.items() if value]
    if len(names) > 1:
        raise EddiError(problem("G000.exclude", options=" and ".join(names)))
    if bag is not None:
        return Recording(bag, speed), "{:10.3f}".format
    uri, number = os.environ.get("ROS_MASTER_URI"), os.environ.get("ROS_DOMAIN_ID", "")
    if not names and not uri and number.isdecimal():
        domains = [int(number)]
    if not domains:
        return Ros1Graph(master or uri or _MASTER), time_of_day
    try:
        from eddi_scaffold.watch.dds_source import DdsGraphs
    except ImportError:
        raise EddiError(problem("I010.cyclonedds")) from None
    return DdsGraphs(dict.fromkeys(domains)), time_of_day


def _serve(source: Source, state: FleetState, clock: Clock, port: int) -> None:
    from eddi_scaffold.watch.following import follow
    from eddi_scaffold.watch.page import Feed, View, open_server

    feed = Feed(View(state.snapshot(0.0), clock))
    with open_server(port, feed) as server:
        console.say(f"the fleet is at http://127.0.0.1:{server.server_port}/ (Ctrl-C ends)")
        threading.Thread(target=server.serve_forever, daemon=True).start()
        try:
            follow(source, state, lambda now, notes: feed.show(View(now, clock, notes)))
            threading.Event().wait()
        finally:
            server.shutdown()
