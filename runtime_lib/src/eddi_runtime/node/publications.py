"""What nodes on DDS share: how they read and write, and why nothing comes from a publication."""

from __future__ import annotations

from typing import Any, Dict, Mapping


def reading_qos(requested: Mapping[str, Any], depth: int) -> Dict[str, Any]:
    """Return how evidence is read: as sensor data, so that every publisher fits.

    What is kept for who comes later is sent again only to who reads reliably (Fast DDS).
    """
    kept = requested.get("durability") == "transient_local"
    reliability = "reliable" if kept else "best_effort"
    return {"reliability": reliability, "durability": "volatile", "depth": depth, **requested}


def writing_qos(requested: Mapping[str, Any], depth: int) -> Dict[str, Any]:
    """Return how results are written: none is lost, and who comes late gets the last one."""
    usual = {"reliability": "reliable", "durability": "transient_local", "depth": depth}
    return {**usual, **requested}


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
        alive: one of them gives a sign of life; ``None`` where that cannot be known.
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
