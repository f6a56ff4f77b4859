# ruff: noqa: N999 - the names of D7.2
"""The monitor as a generated package has it."""

import eddi_runtime


class EDDIMonitor:
    def __init__(self, model=None):
        self.monitor = eddi_runtime.load(model)

    def execute_step(self, eddi_input):
        return self.monitor.execute_step(eddi_input)
