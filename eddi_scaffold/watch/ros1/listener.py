"""Messages of monitors on a ROS 1 graph, as lines of JSON: a program of its own.

It runs on a Python that has rospy, which need not be that of eddi-scaffold: Python 3.8, the
standard library and ROS only. Its argument is a JSON object: type -> text of the ``.msg`` file, of
all messages of monitors. It ends when its standard input does, and when the master has forgotten
it; then it is started again.
"""

from __future__ import annotations

import json
import os
import sys
import threading
from typing import Any, TextIO

import genpy
import rosgraph
import rospy
from genpy.dynamic import generate_dynamic
from std_msgs.msg import Header

try:
    from diagnostic_msgs.msg import DiagnosticArray
except ImportError:  # then the reasons have no topics and ages
    DiagnosticArray = None
DIAGNOSTICS = "/diagnostics"
OURS = b"runtime_version"  # what is in the diagnostics of no other node
STAMP = 12  # bytes of a message before the frame of its header: number and stamp
MAX_TOPICS = 6_000
MAX_SENDERS = 20_000
EVERY_S = 1.0


class Listener:
    """Follows every topic of a known type."""

    def __init__(self, texts: dict[str, str], lines: TextIO) -> None:
        self.lines = lines
        parts = {**texts, Header._type: Header._full_text}
        text = "".join(f"\n{'=' * 80}\nMSG: {name}\n{part}" for name, part in parts.items())
        first = next(iter(texts))
        self.classes: dict[str, Any] = generate_dynamic(first, texts[first] + text)
        self.own = set(self.classes)
        if DiagnosticArray is not None:
            self.classes[DiagnosticArray._type] = DiagnosticArray
        self.master = rosgraph.Master("/eddi_watch")
        self.subscribers: dict[str, Any] = {}
        self.last: dict[tuple[str, str], tuple[Any, bytes]] = {}  # header and bytes
        self.bad: dict[tuple[str, str], str] = {}
        self.lock = threading.Lock()
        self.ended = threading.Event()

    def wait_for_end(self) -> None:
        """Wait until nobody is there any more who reads."""
        sys.stdin.read()
        self.ended.set()

    def look(self) -> bool:
        """Follow what is new; return False where all has to begin anew.

        The master does not know this node any more, or others came and went for years.
        """
        publishers, subscribers, _ = self.master.getSystemState()
        types = dict(self.master.getTopicTypes())
        name = rospy.get_name()
        known = {topic for topic, nodes in subscribers if name in nodes}
        if not known >= self.subscribers.keys() or len(self.last) + len(self.bad) > MAX_SENDERS:
            return False
        for topic, _ in publishers:
            kind = types.get(topic)
            if topic in self.subscribers or len(self.subscribers) >= MAX_TOPICS:
                continue
            if kind in self.classes and (topic == DIAGNOSTICS or kind in self.own):
                self.subscribers[topic] = rospy.Subscriber(
                    topic, rospy.AnyMsg, self.take, (topic, kind), tcp_nodelay=True
                )
        return True

    def take(self, message: Any, about: tuple[str, str]) -> None:
        """Send a message on; of one that equals the last one, only that it came."""
        topic, kind = about
        header, data, cls = message._connection_header, message._buff, self.classes[kind]
        key = (topic, str(header.get("callerid")))
        if header.get("md5sum") != cls._md5sum:
            self.bad[key] = f"{topic}: {key[1]} has another definition of {kind}"
            return
        if topic == DIAGNOSTICS and OURS not in data:
            return
        last_header, last = self.last.get(key, (None, b""))
        is_first = last_header is not header  # of a connection
        kept = is_first and header.get("latching") == "1"
        line = {"topic": topic, "type": kind, "node": key[1], "kept": kept}
        if is_first or last != data[STAMP:]:
            try:
                line["content"] = plain(cls().deserialize(data))
            except Exception as failure:  # noqa: BLE001 - whatever the bytes make of genpy
                self.bad[key] = f"{topic} of {key[1]}: {failure}"
                return
        self.last[key] = (header, data[STAMP:])
        self.bad.pop(key, None)
        self.send(line)

    def send(self, line: dict[str, Any]) -> None:
        """Write a line to who has started this."""
        with self.lock:
            self.lines.write(json.dumps(line) + "\n")
            self.lines.flush()

    def run(self) -> None:
        """Look for publishers until the end, or until the master has forgotten this node."""
        is_known = True
        while is_known and not self.ended.wait(EVERY_S if self.subscribers else EVERY_S / 4):
            notes: list[str] = []
            try:
                self.master.getPid()
                if not rospy.core.is_initialized():
                    rospy.init_node(
                        "eddi_watch",
                        anonymous=True,
                        disable_rosout=True,
                        disable_rostime=True,
                        disable_signals=True,
                    )
                is_known = self.look()
            except OSError as failure:
                notes = [f"the ROS master does not answer: {failure}"]
            except Exception as failure:  # noqa: BLE001 - it answers what no master does
                notes = [f"the ROS master answers nonsense: {failure}"]
            self.send({"notes": [*notes, *list(self.bad.values())[:20]]})


def plain(value: Any) -> Any:
    """Return a value of a message as JSON has it."""
    if isinstance(value, genpy.Message):
        return {name: plain(getattr(value, name)) for name in value.__slots__}
    if isinstance(value, (list, tuple, bytes)):
        return [plain(part) for part in value]
    return None if isinstance(value, genpy.TVal) else value


if __name__ == "__main__":
    own = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # whatever rospy prints is no line of ours
    listener = Listener(json.loads(sys.argv[1]), own)
    listener.send({"notes": []})
    threading.Thread(target=listener.wait_for_end, daemon=True).start()
    listener.run()
    rospy.signal_shutdown("the view has ended")
