"""ConSertA: compiled by eddi-scaffold, do not edit.

Model: two_conserts.xml //@odeProductPackages.0/@conSerts.0
"""

import eddi_runtime
from eddi_runtime import InputSpec, consert

eddi_runtime.needs(__file__, {eddi_runtime: 1, consert: 1})
# sha256 of the lines below: f9a21c3ba8729242c4970e1b667c9c7141344457a2386bd9b0bbce3b9e6ffdbb


class Monitor(consert.ConSert):
    model_id = "ConSertA"
    digest = "c6ada5b9091eb58f55151872750df567e941aac619dd774f943aa46684ad3881"
    inputs = (
        # //@odeProductPackages.0/@conSerts.0/@demands.0
        InputSpec("RtE_A_D0", "RtE_A_D0", requires=("consertb",), max_age=0.5, default=False),
        # //@odeProductPackages.0/@conSerts.0/@runtimeEvidence.0
        InputSpec("RtE_A_E0", "RtE_A_E0", requires=("RtE_E0",), max_age=2.0, default=False),
    )
    leaves = (consert.Binary(), consert.Binary())
    # Name, gate, numbers of what it reads: the inputs first, then these nodes.
    nodes = (
        ("System_A_AND", "And", (1, 0)),  # 2
        ("System_A_G0", "And", (1,)),  # 3
        ("System_A_G1", "And", (2,)),  # 4
    )
    guarantees = (consert.Guarantee("System_A_G0", 3), consert.Guarantee("System_A_G1", 4))
    services = (("ServiceA", ("System_A_G0", "System_A_G1")),)

    def step(self, source):
        try:
            raw = (source.RtE_A_D0, source.RtE_A_E0)
        except Exception:
            raw = self.read(source)
        self.raw, self.source = raw, source
        RtE_A_D0, RtE_A_E0 = raw
        # RtE_A_D0: //@odeProductPackages.0/@conSerts.0/@demands.0
        if RtE_A_D0 is True:
            RtE_A_D0 = 2
        else:
            RtE_A_D0 = 0 if RtE_A_D0 is False else self.judge(0, RtE_A_D0)
        # RtE_A_E0: //@odeProductPackages.0/@conSerts.0/@runtimeEvidence.0
        if RtE_A_E0 is True:
            RtE_A_E0 = 2
        else:
            RtE_A_E0 = 0 if RtE_A_E0 is False else self.judge(1, RtE_A_E0)
        # And System_A_AND: //@odeProductPackages.0/@conSerts.0/@consertGates.0
        System_A_AND = RtE_A_E0 if RtE_A_E0 < RtE_A_D0 else RtE_A_D0
        return (
            RtE_A_E0 == 2,  # System_A_G0: //@odeProductPackages.0/@conSerts.0/@guarantees.0
            System_A_AND == 2,  # System_A_G1: //@odeProductPackages.0/@conSerts.0/@guarantees.1
        )

    def execute_step(self, source, t_ns=None):
        System_A_G0, System_A_G1 = self.step(source)
        return [
            {"id": "System_A_G0", "active": System_A_G0},
            {"id": "System_A_G1", "active": System_A_G1},
        ]
