"""Conditional events (SESAME D7.2 section 3.5): a language, its checks, and its targets.

``analyse`` reads a text, finds all that is wrong with it, and makes the program that the
targets print. Nothing here knows ROS, a kind or the command line.
"""

from __future__ import annotations

from eddi_scaffold.conditions.analysis import Analysis, analyse
from eddi_scaffold.conditions.scope import Type, Variable

__all__ = ["Analysis", "Type", "Variable", "analyse"]
