# ruff: noqa: N802, N803, N999 - the names of D7.2
from eddi_runtime import EDDIInputBase


class EDDIInput(EDDIInputBase):
    def __init__(self):
        super().__init__()
        self.RtE_B_E0 = None

    def process_RtE_B_E0(self, RtE_E0):
        self.RtE_B_E0 = RtE_E0.data

    def processing(self, simulator_outputs):
        self.update("RtE_B_E0", self.process_RtE_B_E0, simulator_outputs, ("RtE_E0",))
