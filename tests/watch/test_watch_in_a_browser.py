"""The page of a fleet as a person uses it, in a real browser.

``EDDI_SCREENSHOT=docs/watch.png pytest tests/watch/test_watch_in_a_browser.py`` takes the picture
of the documentation anew.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import pytest

from eddi_scaffold.watch.messages import Message
from tests.conditions.browser import Browser
from tests.watch.served import Fleet, serving

pytestmark = pytest.mark.slow


@pytest.fixture
def browser(tmp_path: Path) -> Iterator[Browser]:
    found = Browser(tmp_path)
    yield found
    found.end()


def row(robot: int, name: str) -> str:
    rows = f"document.querySelectorAll('section:nth-of-type({robot}) tbody tr')"
    return f"[...{rows}].find((r) => r.cells[1].innerText === '{name}').innerText"


def test_it_stays_new_and_says_what_changed(browser: Browser) -> None:
    fleet = Fleet()
    with serving(fleet) as port:
        browser.open(f"http://127.0.0.1:{port}/")
        assert "No monitor has been heard of" in browser.script("document.body.innerText")
        fleet.play(10.0)
        browser.wait(f"{row(1, 'FullSpeed')}.includes('● active')")
        browser.script("document.querySelector('#r0-graph summary').focus()")
        fleet.play(12.5)
        browser.wait(f"{row(1, 'FullSpeed')}.includes('not active')")
        assert "PathClear" in browser.script(row(1, "FullSpeed"))
        assert browser.script("document.activeElement.innerText") == "Graph"  # where it was
        browser.wait("document.getElementById('said').innerText.includes('changes')")
        fleet.play(16.0, robots=("/robot1",))
        browser.wait(f"{row(2, 'StandStill')}.includes('no message for more than 3 s')")
        browser.wait("[...document.images].every((one) => one.naturalWidth > 300)")
        new = "[...document.images].every((one) => one.src.endsWith(one.dataset.next))"
        browser.wait(f"{new} && [...document.images].every((one) => one.complete)")
        wanted = os.environ.get("EDDI_SCREENSHOT")
        if wanted:
            browser.screenshot(Path(wanted))
    browser.wait("document.getElementById('link').innerText.includes('Not connected')")


def test_the_keyboard_reaches_everything_and_parts_have_names(browser: Browser) -> None:
    fleet = Fleet()
    fleet.play(5.0, robots=("/robot1",))
    with serving(fleet) as port:
        browser.open(f"http://127.0.0.1:{port}/")
        browser.press("Tab")
        assert browser.script("document.activeElement.innerText") == "Skip to the last changes"
        browser.press("Enter")
        browser.wait("document.activeElement.id === 'changes-title'")
        tree = browser.call("Accessibility.getFullAXTree")["nodes"]
        found = {
            (node["role"]["value"], node.get("name", {}).get("value", ""))
            for node in tree
            if not node.get("ignored")
        }
        assert ("table", "Guarantees of /robot1") in found
        assert ("rowheader", "FullSpeed") in found
        assert ("columnheader", "State") in found
        assert ("region", "/robot1") in found
        assert ("status", "") in found


def test_it_works_without_javascript(browser: Browser) -> None:
    fleet = Fleet()
    fleet.play(5.0)
    with serving(fleet) as port:
        browser.call("Emulation.setScriptExecutionDisabled", value=True)
        browser.open(f"http://127.0.0.1:{port}/")
        assert "FullSpeed" in browser.script("document.body.innerText")


def test_nothing_that_a_robot_sends_runs(browser: Browser) -> None:
    attack = "<img src=x onerror='window.hit=1'><script>window.hit=1</script>"
    fleet = Fleet()
    with serving(fleet) as port:
        browser.open(f"http://127.0.0.1:{port}/")
        rows = [SimpleNamespace(id=attack, verdict=1, missing=[attack])]
        content = SimpleNamespace(model_id=attack, model_digest="", guarantees=rows, accepted=[])
        fleet.take(Message("/r/a/b", "eddi_messages/ConSertStatus", content, 0.0))
        fleet.show()
        browser.wait("document.querySelectorAll('tbody tr').length === 1")
        browser.wait("document.getElementById('said').innerText.includes('onerror')")
        assert browser.script("window.hit === undefined") is True
        assert browser.script("document.querySelectorAll('img[src=x]').length") == 0
