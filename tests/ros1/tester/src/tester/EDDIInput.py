# ruff: noqa: N802, N999 - the names of D7.2
from eddi_runtime import EDDIInputBase


class EDDIInput(EDDIInputBase):
    def __init__(self):
        super().__init__()
        self.E = self.F = False

    def process_E(self, how):
        self.E = how.data == "true"

    def process_F(self, flag):
        self.F = flag.data

    def processing(self, simulator_outputs):
        self.update("E", self.process_E, simulator_outputs, ("how",))
        self.update("F", self.process_F, simulator_outputs, ("flag",))
