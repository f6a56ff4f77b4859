#!/usr/bin/env python3
"""Write the table of common message types from the ``.msg`` files of Debian's packages.

mkdir /tmp/debs && cd /tmp/debs
apt-get download $(script/common_messages.py --packages)
for deb in *.deb; do dpkg -x $deb root; done
script/common_messages.py root/usr/share > eddi_scaffold/monitors/message_types/common.txt
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from eddi_scaffold.config.field_types import Fields, fields_of

PACKAGES = (
    "actionlib_msgs", "diagnostic_msgs", "geometry_msgs", "nav_msgs", "rosgraph_msgs",
    "sensor_msgs", "shape_msgs", "std_msgs", "stereo_msgs", "tf2_msgs", "trajectory_msgs",
    "visualization_msgs",
)  # fmt: skip
HEADER = """\
# The common message types of ROS 1: type: fields, without constants.
# Made by script/common_messages.py from the .msg files of Debian 12, do not edit.
# They are those of std_msgs, common_msgs, ros_comm_msgs and geometry2,
# (c) 2008-2010 Willow Garage, Inc. and others, BSD-3-Clause.
"""


def line_of(name: str, fields: Fields) -> str:
    """Return the line of one message."""
    return f"{name}: {', '.join(f'{of} {field}' for field, of in fields.items())}".rstrip()


def lines(share: Path) -> Iterator[str]:
    """Return the lines of the table for the packages below a folder."""
    for package in PACKAGES:
        messages = sorted((share / package / "msg").glob("*.msg"))
        if not messages:
            sys.exit(f"{share} has no messages of {package}")
        for file in messages:
            fields = fields_of(file.read_text("utf-8"), package)
            yield line_of(f"{package}/{file.stem}", fields)


def main() -> None:
    """Print the table, or the names of the Debian packages that it is made of."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("share", nargs="?", type=Path, default=Path("/usr/share"))
    parser.add_argument("--packages", action="store_true", help="print Debian's package names")
    options = parser.parse_args()
    if options.packages:
        print(*(f"ros-{name.replace('_', '-')}" for name in PACKAGES))
        return
    sys.stdout.write(HEADER)
    sys.stdout.writelines(f"{line}\n" for line in lines(options.share))


if __name__ == "__main__":
    main()
