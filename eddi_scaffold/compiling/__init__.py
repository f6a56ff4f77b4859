"""Models compiled to the Python that runs on the robot: standard library only.

Kinds make a monitor of a typed model; here is what they share, and how the text is put together.
"""
