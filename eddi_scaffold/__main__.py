"""``python -m eddi_scaffold``."""

from eddi_scaffold.cli import program

program()
