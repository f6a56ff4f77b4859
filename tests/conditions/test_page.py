"""The page over HTTP: what it answers and what it refuses."""

import re
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import AbstractContextManager
from pathlib import Path
from urllib.parse import urlencode

import pytest

from eddi_scaffold.cli.event import _read_signal
from eddi_scaffold.common.local_server import MAX_BODY
from eddi_scaffold.common.problems import EddiError
from eddi_scaffold.conditions.event_page import open_server
from tests.diagnosed import assert_reported
from tests.pages import ask, served

D72 = "AVERAGE(temp, 5s) > 100 AND TIME(warning == TRUE, 5s)"


@pytest.fixture
def port() -> Iterator[int]:
    with serving() as result:
        yield result


def serving() -> AbstractContextManager[int]:
    return served(open_server(0, _read_signal))


def send(port: int, path: str, **form: str) -> tuple[int, dict[str, str], str]:
    kind = "application/x-www-form-urlencoded"
    return ask(port, path, "POST", urlencode(form), Content_Type=kind)


def test_the_page_and_its_files(port: int) -> None:
    status, headers, text = ask(port, "/")
    assert status == 200
    assert "<form" in text
    assert headers["Content-Security-Policy"].startswith("default-src 'none'")
    assert "http" not in text.replace("/check", "")  # nothing from outside
    assert ask(port, "/style.css")[0] == 200
    assert ask(port, "/../server.py")[0] == 404
    assert ask(port, "/other", "POST", "x")[0] == 404


def test_check_shows_the_place_of_an_error(port: int) -> None:
    status, _, text = send(port, "/check", text="x > \ny", rate="10")
    assert status == 200
    assert "No errors." in text
    _, _, text = send(port, "/check", text="x > 1 > 2", rate="10")
    assert "1:7 comparisons do not chain [E001]" in text
    assert "<pre>x &gt; 1 &gt; 2\n      ^</pre>" in text
    _, _, text = send(port, "/check", text="x > 1", rate="often")
    assert "the rate &#x27;often&#x27; is not a number" in text


def test_generate_shows_the_code(port: int) -> None:
    _, _, text = send(port, "/generate", text=D72, rate="10", target="python", name="demo")
    assert "demo_event.py" in text
    assert "class Monitor(Variables):" in text
    _, _, text = send(port, "/generate", text=D72, rate="10", target="c", name="demo")
    assert "demo_event.h" in text
    _, _, text = send(port, "/generate", text="x >", target="c")
    assert "#include" not in text


def test_download(port: int) -> None:
    form = {"text": D72, "rate": "10", "name": "demo", "download": "1"}
    _, headers, text = send(port, "/generate", **form)
    assert headers["Content-Disposition"] == 'attachment; filename="demo_event.py"'
    assert text.startswith('"""Monitor of events')
    _, headers, text = send(port, "/generate", **form, target="c")
    assert headers["Content-Disposition"] == 'attachment; filename="demo_main.zip"'
    names = re.findall("demo_[a-z]+[.][ch]", text)
    # the last ones are those of the archive's directory
    assert names[-4:] == ["demo_event.h", "demo_event.c", "demo_main.c", "demo_vectors.c"]


def test_a_signal_is_drawn(port: int) -> None:
    _, _, text = send(port, "/check", text="x > 5", signal="t,x\n0,1\n1,9\n2,nan\n")
    assert 'src="data:image/svg+xml;base64,' in text
    _, _, text = send(port, "/check", text="x > 5", signal="t,y\n0,1\n")
    assert "no input has the id &#x27;y&#x27; [I003]" in text


def test_what_was_typed_is_never_markup(port: int) -> None:
    attack = "</textarea><script>alert(1)</script>\"'<img src=x onerror=alert(1)>"
    for path in ("/check", "/generate"):
        for text in (attack, f"x > 5 // {attack}"):
            answer = send(port, path, text=text, name=attack, rate=attack, signal=attack)[2]
            assert "<script>" not in answer
            assert "<img src=x" not in answer


def test_others_are_refused(port: int) -> None:
    for host in ("evil.example", "localhost", "localhost:1", f"LOCALHOST:{port}", f"x:{port}"):
        assert ask(port, "/", Host=host)[0] == 403
    assert ask(port, "/", Host=f"localhost:{port}")[0] == 200
    form = {"Content_Type": "application/x-www-form-urlencoded"}
    for origin in ("http://evil.example", "null"):
        assert ask(port, "/check", "POST", "text=x", Origin=origin, **form)[0] == 403
    own = f"http://127.0.0.1:{port}"
    assert ask(port, "/check", "POST", "text=x", Origin=own, **form)[0] == 200
    assert ask(port, "/check", "POST", "text=x", Content_Type="text/plain")[0] == 415


def raw(port: int, head: str, body: bytes = b"") -> bytes:
    """Send lines as they are, and no more; return the first line of the answer."""
    with socket.create_connection(("127.0.0.1", port), timeout=10) as connection:
        start = f"POST /check HTTP/1.0\r\nHost: 127.0.0.1:{port}\r\n{head}\r\n"
        connection.sendall(start.encode("latin-1") + body)
        connection.shutdown(socket.SHUT_WR)
        with connection.makefile("rb") as answer:
            return answer.readline()


@pytest.mark.parametrize("length", ["x", "-1", "+3", "1_0", "\xb2", " ", "3, 3", "1" * 5000])
def test_a_bad_content_length_is_a_bad_request(port: int, length: str) -> None:
    kind = "Content-Type: application/x-www-form-urlencoded\r\n"
    assert b" 400 " in raw(port, f"{kind}Content-Length: {length}\r\n", b"a=b")


def test_lengths_that_do_not_fit(port: int) -> None:
    kind = "Content-Type: application/x-www-form-urlencoded\r\n"
    assert b" 200 " in raw(port, f"{kind}Content-Length: 3\r\n", b"a=b")
    assert b" 400 " in raw(port, f"{kind}Content-Length: 4\r\n", b"a=b")
    assert b" 400 " in raw(port, kind, b"a=b")


def test_long_texts_are_refused(port: int) -> None:
    form = {"Content_Type": "application/x-www-form-urlencoded"}
    assert ask(port, "/check", "POST", "text=" + "x" * 100_000, **form)[0] == 413
    assert ask(port, "/check", "POST", "text=" + "a+AND+" * 10_000 + "a", **form)[0] == 200
    assert MAX_BODY == 64 * 1024


def test_it_listens_on_the_loopback_interface_only(port: int) -> None:
    with open_server(0, _read_signal) as server:
        assert server.server_address[0] == "127.0.0.1"
    with pytest.raises(EddiError) as caught:
        open_server(port, _read_signal)
    (problem,) = caught.value.problems
    assert_reported("E024", [problem])


def test_the_page_begins_with_the_file_that_was_given(tmp_path: Path) -> None:
    (tmp_path / "hot.events").write_text("EVENT Hot := temp > 81.5\n")
    words = ["event", "hot.events", "--rate", "4", "--serve", "--port", "0"]
    command = [sys.executable, "-m", "eddi_scaffold", *words]
    with subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True) as page:
        assert page.stderr is not None
        result = re.search(r"127\.0\.0\.1:(\d+)/", page.stderr.readline())
        try:
            assert result is not None
            _, _, text = ask(int(result[1]), "/")
        finally:
            page.terminate()
    assert "EVENT Hot := temp &gt; 81.5" in text
    assert 'value="4"' in text
