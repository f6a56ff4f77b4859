"""Monitors that are wired to each other by topics, and whether what is wired may be relied on.

A monitor by itself takes a missing or old message as unknown. Behind another monitor that is not
enough: its messages go on when its own sources have died. So every field of a monitor's message
that is read must have a meaning only where something is known, each demand must be fulfilled by the
guarantee that it is wired to, and no claim may rest on itself.
"""
