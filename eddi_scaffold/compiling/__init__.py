"""Models compiled to the Python that runs on the robot: standard library only.

Copier runs this folder from a template's checkout, so that a plain ``copier update`` brings new
logic; ``generate`` and ``run`` call the same functions.
"""
