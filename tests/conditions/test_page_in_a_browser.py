"""The page as a person uses it, by the keyboard only, with and without JavaScript.

``EDDI_SCREENSHOT=docs/event-creator.png pytest tests/conditions/test_page_in_a_browser.py`` takes
the picture of the documentation anew.
"""

from __future__ import annotations

import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

from eddi_scaffold.cli.event import _read_signal
from eddi_scaffold.conditions.event_page import open_server
from tests.conditions.browser import Browser

D72 = "AVERAGE(temp, 5s) > 100 AND TIME(warning == TRUE, 5s)"


@pytest.fixture
def address() -> Iterator[str]:
    with open_server(0, _read_signal) as server:
        thread = threading.Thread(target=server.serve_forever, args=(0.02,), daemon=True)
        thread.start()
        yield f"http://127.0.0.1:{server.server_port}/"
        server.shutdown()
        thread.join()


@pytest.fixture
def browser(tmp_path: Path) -> Iterator[Browser]:
    found = Browser(tmp_path)
    yield found
    found.end()


def result(browser: Browser) -> str:
    return str(browser.script("document.getElementById('result').innerText"))


def tab_to(browser: Browser, name: str) -> None:
    for _ in range(20):
        if browser.focus() == name:
            return
        browser.press("Tab")
    raise AssertionError(f"the keyboard does not reach {name}")


def replace_text(browser: Browser, text: str) -> None:
    browser.press("a", ctrl=True)
    browser.type(text)


def asked(browser: Browser) -> None:
    browser.wait("document.getElementById('result').innerText.length > 5")


@pytest.mark.slow
def test_check_mend_generate_and_copy_by_the_keyboard(browser: Browser, address: str) -> None:
    browser.open(address)
    assert browser.focus() == "text"
    replace_text(browser, D72.replace("5s) > 100", "5) > 100"))
    browser.press("Enter", ctrl=True)
    asked(browser)
    assert "E005" in result(browser)
    assert browser.script("document.querySelector('mark').innerText") == "5"
    # the caret stands at the error: what is typed goes there
    browser.wait("document.getElementById('text').selectionStart === 14")
    browser.type("5s")
    tab_to(browser, "check")
    browser.press("Enter")
    browser.wait("document.getElementById('result').innerText.includes('No errors.')")
    tab_to(browser, "generate")
    browser.press("Enter")
    browser.wait("document.getElementById('code0') !== null")
    code = browser.script("document.getElementById('code0').value")
    assert "class Monitor(Variables):" in code
    browser.wait("!document.querySelector('.copy').hidden")
    browser.script("document.querySelector('.copy').focus()")
    browser.press("Enter")
    browser.wait("document.querySelector('.copy').innerText !== 'Copy'")
    assert browser.script("document.getSelection().toString().length") == len(code)


@pytest.mark.slow
def test_nothing_that_is_typed_runs(browser: Browser, address: str) -> None:
    browser.open(address)
    attack = "</textarea><script>window.hit=1</script><img src=x onerror='window.hit=1'>"
    replace_text(browser, f"x > 1 // {attack}")
    tab_to(browser, "name")
    replace_text(browser, attack)
    browser.press("Enter")
    asked(browser)
    assert browser.script("window.hit === undefined") is True
    assert browser.script("document.querySelectorAll('img[src=x]').length") == 0
    assert attack in browser.script("document.getElementById('text').value")
