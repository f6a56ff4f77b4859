"""One robot of many: the generated monitor on the node of the runtime, over a network that fails.

Words travel as datagrams through a relay that loses, delays, repeats and reorders them. Whenever
the robot may enter, the word that it rests on must have been made within the lease, by a clock that
only this test has: each process lives in a time namespace of its own.
"""

import importlib
import json
import random
import resource
import signal
import socket
import sys
import threading
import time
from functools import partial
from pathlib import Path
from types import SimpleNamespace

from eddi_runtime.node.health import Diagnostics
from eddi_runtime.node.node import Node
from eddi_runtime.node.start import Settings
from eddi_runtime.node.topics import Converter, Input, Output
from eddi_runtime.peers import Fleet, Source

given = json.loads(sys.argv[1])
REAL = time.time() - time.monotonic()
"""What this test knows, and no robot: the common time of an instant of this process."""


def message_class(name, fields):
    def begin(self, **values):
        self.__dict__.update(values)

    return type(name, (), {"__init__": begin, "FIELDS": fields})


CLASSES = {name: message_class(name, fields) for name, fields in given["messages"].items()}
WORD = CLASSES["RobotGuarantees"]


def plain(value):
    if isinstance(value, list):
        return [plain(one) for one in value]
    return {k: plain(v) for k, v in vars(value).items()} if hasattr(value, "FIELDS") else value


def read(name, values):
    made = CLASSES[name](**values)
    for field, of in CLASSES[name].FIELDS.items():
        inner = of.partition("[")[0].rpartition("/")[2]
        if inner in CLASSES:
            setattr(made, field, [read(inner, one) for one in values[field]])
    return made


class Robot(Node):
    """The node of a robot on datagrams."""

    NAME, FREQUENCY = "mover", given["frequency"]
    INPUTS = (Input("brake", "brake", None), Input("health", "health", None))
    OUTPUTS = (Output("mover", "guarantees", CLASSES["ConSertOutput"]),)
    FLEET = Fleet(
        given["robot"],
        "/eddi/peers",
        WORD,
        given["lease"],
        (Source("other", (), "mover", given["digest"], "Parked"),),
    )

    def __init__(self, *parts):
        super().__init__(*parts)
        self.began = time.monotonic()
        self.counts = {"steps": 0, "entered": 0, "expired": 0, "wrong": 0}

    def advertise(self, channel):
        return self.send if channel.type is WORD else self.look

    def subscribe(self, source):
        if source.type is WORD:
            threading.Thread(target=self.listen, args=(source.id,), daemon=True).start()

    def send(self, word):
        said = {"made": REAL + self.began, "word": plain(word)}
        line.sendto(json.dumps(said).encode(), relay)

    def listen(self, name):
        while True:
            said = json.loads(line.recv(65536))
            word = read("RobotGuarantees", said["word"])
            word.made = said["made"]
            self._receipts.receive(name, word)

    def _evaluate(self, receipts, new, now):
        self.began = now  # a word is at least as old as the step in which it was made
        return super()._evaluate(receipts, new, now)

    def look(self, message):
        """See what is published: is the word that it rests on within its lease?"""
        counts, active = self.counts, {one.id for one in message.guarantees if one.active}
        counts["steps"] += 1
        if "Enter" in active:
            word = self.simulator_values["other"]
            counts["entered"] += 1
            age = REAL + self.began - word.made
            parked = [one.active for one in word.guarantees if one.id == "Parked"] == [True]
            counts["expired"] += age > given["lease"] + 0.001  # the clock of a test is not exact
            counts["wrong"] += not parked or word.robot == given["robot"]
        if counts["steps"] % 10 == 0:
            write(counts)


def write(counts):
    """Leave the counts behind, also when the process is killed."""
    pages = int(Path("/proc/self/statm").read_text("ascii").split()[1])
    text = json.dumps({**counts, "kilobytes": pages * resource.getpagesize() // 1024})
    new = Path(given["counts"] + ".new")
    new.write_text(text, "utf-8")
    new.replace(given["counts"])


def sensors(node):
    """Feed both sensors; each dies now and then."""
    chance, brake, alive = random.Random(given["seed"]), True, True
    while True:
        if chance.random() < 0.05:
            brake = not brake
        if chance.random() < 0.05:
            alive = not alive
        if alive:
            node._receipts.receive("brake", SimpleNamespace(data=brake))
        node._receipts.receive("health", SimpleNamespace(data=True))
        time.sleep(0.2)


relay = ("127.0.0.1", given["relay"])
line = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
line.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 22)
line.bind(("127.0.0.1", 0))
line.sendto(json.dumps({"robot": given["robot"]}).encode(), relay)

sys.path.insert(0, given["folder"])
module = SimpleNamespace(__name__="eddi_messages.msg", **CLASSES)
node = Robot(
    importlib.import_module("mover.EDDIMonitor").EDDIMonitor(),
    importlib.import_module("mover.EDDIInput").EDDIInput(),
    Converter(
        module,
        lambda cls: cls.FIELDS.items(),
        lambda one: (
            f"eddi_messages/{one.__name__ if isinstance(one, type) else type(one).__name__}"
        ),
        time.time,
    ),
    Settings(given["frequency"], diagnostics=False),
)
node.prepare()
signal.signal(signal.SIGTERM, lambda *_: node.ending.begin())
threading.Thread(target=partial(sensors, node), daemon=True).start()
node.begin("/mover", Diagnostics(lambda _: None))
node.ros_main()
write(node.counts)
