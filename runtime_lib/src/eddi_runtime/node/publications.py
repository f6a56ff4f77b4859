"""What a graph of DDS tells of the publications of a topic from which nothing comes, in words."""

from __future__ import annotations

__all__ = ["fault"]


def fault(
    expected: str,
    age: float | None = None,
    *,
    unreadable: bool = False,
    refused: str = "",
    connected: bool = True,
    alive: bool | None = True,
    deadline: float | None = None,
) -> str:
    """Return why nothing comes although a topic is published with the right type.

    Args:
        expected: that type, as ROS 1 writes it.
        age: of the last message in seconds, ``None`` before the first.
        unreadable: what came last has the name of the type, and another content.
        refused: what of a publication does not fit how this node reads, empty when all does.
        connected: this node listens to one of them.
        alive: one of them still gives a sign of life; ``None`` where that cannot be known.
        deadline: seconds between two messages that a publication promises, if it does.
    """
    if unreadable:
        return f"what is sent there is not {expected}, although it is called so"
    if not connected and refused:
        return f"{refused} that its publisher has does not fit"
    if not connected:
        return "its publisher is there, and not connected"
    if alive is False:
        return "its publisher gives no sign of life"
    if deadline is not None and age is not None and age > deadline:
        return f"its publisher has missed its deadline of {deadline:g} s"
    return f"its publisher is {'registered' if alive is None else 'there'}, and silent"
