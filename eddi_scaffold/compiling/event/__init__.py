"""Events as straight-line Python: read the inputs, then a line for each operation."""
