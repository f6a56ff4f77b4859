"""ConSerts of the test package."""

from runtime_lib.tests.conserts import consert


def _reads(topic, max_age=None):
    return {"requires": [topic], "max_age": max_age}


def tester(max_age):
    """Return the tester's model with an age limit of the input F."""
    specs = {"E": _reads("how"), "F": _reads("flag", max_age)}
    edges = ["E>G_E", "F>G_F"]
    return consert(["E", "F"], guarantees=["G_E", "G_F"], edges=edges, specs=specs, name="Tester")


_WIDE_IDS = [f"G{number}_{'x' * 1000}" for number in range(60)]
MODELS = {
    "wide": consert(
        ["F"],
        guarantees=_WIDE_IDS,
        edges=[f"F>{name}" for name in _WIDE_IDS],
        specs={"F": _reads("flag")},
        name="Wide",
    ),
    "tester": tester(None),
    "tester_half": tester(0.5),
}
