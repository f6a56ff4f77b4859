"""ConSerts as straight-line Python: judge the evidence, then one line for each gate."""
