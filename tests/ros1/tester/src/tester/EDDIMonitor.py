# ruff: noqa: N999 - the names of D7.2
"""The monitor as a generated package has it; each test says where the compiled model lies."""

import importlib.util
import os
from pathlib import Path

path = os.environ.get("COMPILED", "")
if not Path(path).is_file():
    raise ModuleNotFoundError("No module named 'compiled'", name=f"{__package__}.compiled")
spec = importlib.util.spec_from_file_location("compiled", path)
compiled = importlib.util.module_from_spec(spec)
spec.loader.exec_module(compiled)


class EDDIMonitor:
    def __init__(self):
        self.monitor = compiled.Monitor()

    def execute_step(self, eddi_input, t_ns=None):
        return self.monitor.execute_step(eddi_input, t_ns)
