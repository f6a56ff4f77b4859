"""DDS programs of benchmarks/ros_node.py.

dds_node_programs.py measure N PAUSE NAME...   toggles evidence, measures until the answer
dds_node_programs.py callback NAME             the least a node can do: answers at once
"""

from __future__ import annotations

import json
import os
import random
import sys
import time
from typing import Any

from cyclonedds.core import InstanceState, ReadCondition, SampleState, ViewState, WaitSet
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration
from eddi_runtime.transports.dds.graph import participant_of, reading, writing
from eddi_runtime.transports.dds.messages import message_classes

CLASSES = message_classes(
    {
        "std_msgs/Bool": "bool data",
        "eddi_messages/Guarantee": "string id, bool active",
        "eddi_messages/ConSertOutput": "eddi_messages/Guarantee[] guarantees",
    }
)
BOOL, OUTPUT = CLASSES.std_msgs_Bool, CLASSES.eddi_messages_ConSertOutput
PARTICIPANT = participant_of(int(os.environ["ROS_DOMAIN_ID"]))
NEW = writing({"durability": "volatile"}, 1)
ANY = ViewState.Any | InstanceState.Any | SampleState.NotRead


def writer(topic: str, cls: Any) -> Any:
    return DataWriter(PARTICIPANT, Topic(PARTICIPANT, f"rt{topic}", cls), NEW)


class Ear:
    """Waits for the messages of a topic."""

    def __init__(self, topic: str, cls: Any) -> None:
        self._reader = DataReader(
            PARTICIPANT,
            Topic(PARTICIPANT, f"rt{topic}", cls),
            reading({"reliability": "reliable"}, 5),
        )
        self._set = WaitSet(PARTICIPANT)
        self._set.attach(ReadCondition(self._reader, ANY))

    def messages(self, seconds: float) -> list[Any]:
        """Return what has arrived, as soon as something has."""
        self._set.wait(duration(milliseconds=1000 * seconds))
        return [one for one in self._reader.take(50) if one.sample_info.valid_data]


class Target:
    """One node under test: evidence goes in, the guarantee comes back."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.seconds: list[float] = []
        self._evidence = writer(f"/{name}/in/healthy", BOOL)
        self._answers = Ear(f"/{name}/rover/guarantees", OUTPUT)

    def greet(self) -> None:
        """Wait until the node is there and answers."""
        for value in (True, False):
            end = time.monotonic() + 120.0
            while not self._answered(value, 0.3):
                if time.monotonic() > end:
                    sys.exit(f"{self.name}: it is not there")

    def toggle(self, value: bool, timeout: float) -> None:
        """Send evidence and wait for the guarantee that follows from it."""
        sent = time.perf_counter()
        if not self._answered(value, timeout):
            sys.exit(f"{self.name}: no answer within {timeout} s")
        self.seconds.append(time.perf_counter() - sent)

    def _answered(self, value: bool, timeout: float) -> bool:
        end = time.perf_counter() + timeout
        self._evidence.write(BOOL(data=value))
        while time.perf_counter() < end:
            for message in self._answers.messages(0.2):
                if any(one.active for one in message.guarantees) == value:
                    return True
        return False


def measure(count: str, pause: str, *names: str) -> None:
    """Toggle all targets in turn at random phases; print the latencies as JSON."""
    random.seed(1)
    targets = [Target(name) for name in names]
    for target in targets:
        target.greet()
    for _ in range(int(count) // 2):
        for target in targets:
            for value in (True, False):
                time.sleep(random.uniform(0.003, float(pause)))
                target.toggle(value, 20.0)
    print(json.dumps({target.name: target.seconds for target in targets}))


def callback(name: str) -> None:
    """Answer at once, without monitor, ages, diagnostics or any check."""
    ear, out = Ear(f"/{name}/in/healthy", BOOL), writer(f"/{name}/rover/guarantees", OUTPUT)
    while True:
        for message in ear.messages(1.0):
            one = CLASSES.eddi_messages_Guarantee(id="Slow", active=message.data)
            out.write(OUTPUT(guarantees=[one]))


if __name__ == "__main__":
    program, *given = sys.argv[1:]
    {"measure": measure, "callback": callback}[program](*given)
