"""What the programs on a graph have in common that a test steers with JSON lines.

Commands on stdin, what happened on stdout; each program runs in the Python of its transport, and
the test imports none of them.
"""

import json
import sys
import threading
import time

_lock = threading.Lock()
_repeats = {}


def say(**event):
    """Tell the test."""
    with _lock:
        sys.stdout.write(json.dumps(event) + "\n")
        sys.stdout.flush()


def wait_for(count, connected, ended=None):
    """Wait until somebody listens, where that is asked for."""
    while connected and not count() and not (ended and ended.is_set()):
        time.sleep(0.01)


def repeat(topic, hz, begin, publish):
    """Publish again and again from when a publisher is there, until ``stop``."""
    ended = _repeats[topic] = threading.Event()

    def run():
        begin(ended)
        say(event="connected", topic=topic, t=time.monotonic())
        due, sent = time.monotonic(), 0
        while not ended.is_set():
            publish()
            sent += 1
            due += 1.0 / hz
            ended.wait(max(0.0, due - time.monotonic()))
        say(event="sent", topic=topic, count=sent)

    threading.Thread(target=run, daemon=True).start()


def stop(topic):
    _repeats.pop(topic).set()


def heard(topic, data):
    say(event="message", topic=topic, t=time.monotonic(), data=data)


def published(topic):
    say(event="published", topic=topic, t=time.monotonic())


def obey(*commands):
    """Do what the test says, by the names of the functions."""
    say(event="ready")
    named = {function.__name__: function for function in (*commands, stop)}
    for line in sys.stdin:
        command = json.loads(line)
        named[command.pop("do")](**command)
