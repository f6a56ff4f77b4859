"""A view of a fleet: what its monitors publish, which guarantees are active, and why not.

A source gives messages (``messages``), from a recording or from a graph; ``fleet`` makes of them
what is known now, without input or output; ``text`` and the page show it.
"""
