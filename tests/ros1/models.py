"""ConSerts of the test packages."""

from runtime_lib.tests.conserts import consert, numeric


def _reads(topic, max_age=None):
    return {"requires": [topic], "max_age": max_age}


def tester(max_age):
    """Return the tester's model with an age limit of the input F."""
    specs = {"E": _reads("how"), "F": _reads("flag", max_age), "N": _reads("number")}
    return consert(
        ["E", "F", ("N", numeric("[0, 5)"))],
        guarantees=["G_E", "G_F", "G_N"],
        edges=["E>G_E", "F>G_F", "N>G_N"],
        specs=specs,
        name="Tester",
    )


_WIDE_IDS = [f"G{number}_{'x' * 1000}" for number in range(60)]
MODELS = {
    "wide": consert(
        ["F"],
        guarantees=_WIDE_IDS,
        edges=[f"F>{name}" for name in _WIDE_IDS],
        specs={"F": _reads("flag")},
        name="Wide",
    ),
    "conserta": consert(
        ["RtE_A_E0"],
        ["RtE_A_D0"],
        ["And0&"],
        ["System_A_G0", "System_A_G1"],
        ["RtE_A_D0>And0", "RtE_A_E0>And0", "And0>System_A_G0", "RtE_A_D0>System_A_G1"],
        specs={"RtE_A_D0": _reads("consertb", 1.0), "RtE_A_E0": _reads("RtE_E0")},
        order=["RtE_A_D0", "RtE_A_E0"],
        name="ConSertA",
    ),
    "tester": tester(None),
    "tester_half": tester(0.5),
}
