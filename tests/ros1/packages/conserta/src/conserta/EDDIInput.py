# ruff: noqa: N802, N803, N999 - the names of D7.2
from eddi_runtime import EDDIInputBase, by_id, given


class EDDIInput(EDDIInputBase):
    def __init__(self):
        super().__init__()
        self.RtE_A_D0 = None
        self.RtE_A_E0 = None

    def process_RtE_A_D0(self, consertb):
        self.RtE_A_D0 = given(by_id(consertb.guarantees, "System_B_G0").active, True)

    def process_RtE_A_E0(self, RtE_E0):
        self.RtE_A_E0 = RtE_E0.data

    def processing(self, simulator_outputs):
        self.update("RtE_A_D0", self.process_RtE_A_D0, simulator_outputs, ("consertb",))
        self.update("RtE_A_E0", self.process_RtE_A_E0, simulator_outputs, ("RtE_E0",))
