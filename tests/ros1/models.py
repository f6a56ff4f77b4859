"""Models of the test packages, compiled as the generator does it."""

import copy

from eddi_scaffold.compiling.compilation import compile_model
from eddi_scaffold.compiling.document import check_document, digest_of

BINARY = {"kind": "binary", "type": "Test"}


def compiled(document):
    """Return the text of the compiled monitor of a model."""
    return compile_model(check_document(dict(document, sha256=digest_of(document))))


def _input(name, requires, max_age=None):
    return {"id": name, "attribute": name, "requires": [requires], "max_age": max_age}


def _document(name, inputs, **model):
    return {
        "format": 1,
        "kind": "consert",
        "id": name,
        "source": {"file": "test", "sha256": "", "path": ""},
        "settings": {"guarantee_ids": "source"},
        "inputs": inputs,
        "model": {
            "evidence": [],
            "demands": [],
            "gates": [],
            "guarantees": [],
            "edges": [],
            "provided_services": [],
            "required_services": [],
            **model,
        },
    }


def _guarantee(name):
    return {"id": name, "class_name": name, "default": False, "ranking": None}


CONSERTA = _document(
    "ConSertA",
    [_input("RtE_A_D0", "consertb", 1.0), _input("RtE_A_E0", "RtE_E0")],
    evidence=[{"id": "RtE_A_E0", "dimension": BINARY}],
    demands=[{"id": "RtE_A_D0", "dimensions": [BINARY]}],
    gates=[{"id": "And0", "function": "And"}],
    guarantees=[_guarantee("System_A_G0"), _guarantee("System_A_G1")],
    edges=[
        ["RtE_A_D0", "And0"],
        ["RtE_A_E0", "And0"],
        ["And0", "System_A_G0"],
        ["RtE_A_D0", "System_A_G1"],
    ],
)

CONSERTB = _document(
    "ConSertB",
    [_input("RtE_B_E0", "RtE_E0", "none")],
    evidence=[{"id": "RtE_B_E0", "dimension": BINARY}],
    guarantees=[_guarantee("System_B_G0")],
    edges=[["RtE_B_E0", "System_B_G0"]],
)

_RANGE = {"start": "0", "end": "5", "inclusive": False}
TESTER = _document(
    "Tester",
    [_input("E", "how"), _input("F", "flag"), _input("N", "number")],
    evidence=[
        {"id": "E", "dimension": BINARY},
        {"id": "F", "dimension": BINARY},
        {
            "id": "N",
            "dimension": {
                "kind": "numeric",
                "type": "Distance",
                "covered": [_RANGE],
                "subset": True,
                "uom": "m",
            },
        },
    ],
    guarantees=[_guarantee("G_E"), _guarantee("G_F"), _guarantee("G_N")],
    edges=[["E", "G_E"], ["F", "G_F"], ["N", "G_N"]],
)

_WIDE_IDS = [f"G{number}_{'x' * 1000}" for number in range(60)]
WIDE = _document(
    "Wide",
    [_input("F", "flag")],
    evidence=[{"id": "F", "dimension": BINARY}],
    guarantees=[_guarantee(name) for name in _WIDE_IDS],
    edges=[["F", name] for name in _WIDE_IDS],
)

MODELS = {"wide": WIDE, "conserta": CONSERTA, "consertb": CONSERTB, "tester": TESTER}


def tester(max_age):
    """Return the tester's model with an age limit of the input F."""
    document = copy.deepcopy(TESTER)
    document["inputs"][1]["max_age"] = max_age
    return document
