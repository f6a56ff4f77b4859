"""ConSertB: compiled by eddi-scaffold, do not edit.

Model: two_conserts.xml //@odeProductPackages.0/@conSerts.1
"""

import eddi_runtime
from eddi_runtime import InputSpec, consert

eddi_runtime.needs(__file__, {eddi_runtime: 1, consert: 1})
# sha256 of the lines below: 73b715218ca923afcb38e416f010c1db4595e8b284086c922e5c8335e01132b7


class Monitor(consert.ConSert):
    model_id = "ConSertB"
    digest = "afd9c286a214278768d891c436fe1cbf91c86163010419a8b53da90adfb56d22"
    inputs = (
        # //@odeProductPackages.0/@conSerts.1/@runtimeEvidence.0
        InputSpec("RtE_A_E0", "RtE_A_E0", requires=("RtE_E0",), max_age=2.0, default=False),
    )
    leaves = (consert.Binary(),)
    # Name, gate, numbers of what it reads: the inputs first, then these nodes.
    nodes = (
        ("System_A_G0_c2", "And", (0,)),  # 1
    )
    guarantees = (consert.Guarantee("System_A_G0_c2", 1),)
    services = (("ServiceB", ("System_A_G0_c2",)),)

    def step(self, source):
        try:
            raw = (source.RtE_A_E0,)
        except Exception:
            raw = self.read(source)
        self.raw, self.source = raw, source
        (RtE_A_E0,) = raw
        # RtE_A_E0: //@odeProductPackages.0/@conSerts.1/@runtimeEvidence.0
        if RtE_A_E0 is True:
            RtE_A_E0 = 2
        else:
            RtE_A_E0 = 0 if RtE_A_E0 is False else self.judge(0, RtE_A_E0)
        return (
            RtE_A_E0 == 2,  # System_A_G0_c2: //@odeProductPackages.0/@conSerts.1/@guarantees.0
        )

    def execute_step(self, source, t_ns=None):
        (System_A_G0_c2,) = self.step(source)
        return [{"id": "System_A_G0_c2", "active": System_A_G0_c2}]
