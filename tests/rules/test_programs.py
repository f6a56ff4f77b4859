"""One function starts a program, and that program is git."""

from __future__ import annotations

import re

from tests.checkouts import HERE

GIT, ROSPY = "eddi_scaffold/regions/git.py", "eddi_scaffold/watch/ros1/__init__.py"
REFUSES = "shapes.jinja"
"""It names modules of Python to refuse them."""
TESTS = "copier_templates/ros2_monitor/.eddi/new/{{ stage }}/test/"
"""`colcon test` starts the node of a package."""
SHIPPED = ("eddi_scaffold", "runtime_lib/src", "copier_templates", "script", "hatch_build.py")
STARTS = re.compile(
    r"\b(subprocess|Popen|pty|posix_spawnp?|create_subprocess_\w+|multiprocessing|webbrowser"
    r"|os\.(system|popen|startfile|exec\w+|spawn\w+|fork\w*)"
    r"|from os import)\b"
)


def test_git_and_the_python_of_ros_are_the_only_programs() -> None:
    files = {
        path
        for place in SHIPPED
        for path in (HERE / place, *(HERE / place).rglob("*"))
        if path.is_file() and path.suffix in {".py", ".jinja"} and path.name != REFUSES
    }
    found = {path.relative_to(HERE).as_posix(): path.read_text("utf-8") for path in files}
    starting = [name for name, text in sorted(found.items()) if STARTS.search(text)]
    assert [name for name in starting if not name.startswith(TESTS)] == [GIT, ROSPY]
    assert re.findall(r'\["[^\]"]*"', found[GIT]) == ['["git"']
    assert re.findall(r"\[python, _\w+", found[ROSPY]) == ["[python, _LISTENER"]
    for name in (GIT, ROSPY):
        assert len(re.findall(r"subprocess\.\w+\(", found[name])) == 1
