"""The messages of a ROS 1 graph, by rospy."""

from __future__ import annotations

import contextlib
import json
import os
import select
import shutil
import subprocess
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from eddi_scaffold.common.problems import EddiError, problem
from eddi_scaffold.kinds import texts_of_messages
from eddi_scaffold.monitors.publications import MESSAGE_PACKAGE
from eddi_scaffold.watch.messages import GATHER_S, Message

SYSTEM_PYTHON = "/usr/bin/python3"
_LISTENER = Path(__file__).with_name("listener.py")
_END_S = 3.0


class Ros1Graph:
    """What the monitors of a master publish, from now on; times are of the monotonic clock.

    rospy runs in a process of its own, on the Python that ROS is installed for: eddi-scaffold may
    be in a virtual environment of another one. It is started again when it ends, as it does when
    the master was started anew, which knows nobody.

    Raises:
        EddiError: no Python here has rospy (I010).
    """

    def __init__(self, master: str) -> None:
        self._environment = {**os.environ, "ROS_MASTER_URI": master}
        self._contents: dict[tuple[str, str], object]
        self._notes: Sequence[str] = ()
        self._rest = b""
        self._process: Any
        for python in dict.fromkeys((shutil.which("python3"), SYSTEM_PYTHON)):
            if python is not None and self._is_started(python):
                self._python = python
                return
        raise EddiError(problem("I010.rospy"))

    def _is_started(self, python: str) -> bool:
        messages = texts_of_messages().items()
        texts = {f"{MESSAGE_PACKAGE}/{name}": text for name, text in messages}
        with contextlib.suppress(OSError):
            self._process = subprocess.Popen(
                [python, _LISTENER, json.dumps(texts)],
                env=self._environment,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                bufsize=0,
                start_new_session=True,  # Ctrl-C is for the view, which ends it
            )
            self._contents = {}
            if self._process.stdout.readline():
                os.set_blocking(self._process.stdout.fileno(), False)
                return True
            self.close()
        return False

    def receive(self, seconds: float) -> tuple[float, Sequence[Message]]:
        """Wait for messages, and return what came."""
        if select.select([self._process.stdout], [], [], seconds)[0]:
            time.sleep(GATHER_S)
        now, messages = time.monotonic(), []
        for line in self._read():
            if hasattr(line, "notes"):
                self._notes = line.notes
                continue
            key = line.topic, line.node
            if hasattr(line, "content"):
                self._contents[key] = line.content
            # Equal messages are one object: it is looked at once.
            content = self._contents[key]
            messages.append(Message(line.topic, line.type, content, now, line.node, line.kept))
        return now, messages

    def _read(self) -> Iterator[Any]:
        data = self._rest
        while block := self._process.stdout.read(1 << 20):
            data += block
        *lines, self._rest = data.split(b"\n")
        if block is not None:  # the listener has ended; else there is no more for now
            self._rest = b""
            self.close()
            if not self._is_started(self._python):
                raise EddiError(problem("I010.rospy"))
        return (json.loads(line, object_hook=lambda of: SimpleNamespace(**of)) for line in lines)

    def notes(self) -> Sequence[str]:
        """Return who cannot be listened to, and why."""
        return self._notes

    def close(self) -> None:
        """End the listener, so that it takes leave of the master."""
        self._process.stdin.close()
        try:
            self._process.wait(_END_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._process.stdout.close()
