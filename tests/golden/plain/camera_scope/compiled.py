"""camera_scope: compiled by eddi-scaffold, do not edit.

Model: safeml_config.yml
"""

from . import eddi_runtime
from .eddi_runtime import InputSpec, safeml

eddi_runtime.needs(__file__, {eddi_runtime: 1, safeml: 1})
# sha256 of the lines below: 225484fcc678dee36170f5832fca5d6b139be430319793a330d7e6fe6cc208a8


class Monitor(safeml.SafeML):
    model_id = "camera_scope"
    digest = "a4cde7c00af13b9ad7951c894a371bf0d36ac9bddc2387b998ae9b178c1a2cf5"
    inputs = (InputSpec("frame", "frame", requires=("features",), every_message=True),)
    metric = "ad"
    metric_name = "AndersonDarlingDistance"
    window_size = 50
    stride = 1
    significance_level = 0.01
    # Distance of 1500 reference values and 50 of the window
    threshold = 6.87807403
    threshold_theoretical = 5.13010637
    # Critical values with their levels, and the slope beyond
    tail = safeml.Interpolated(
        (
            (0.774059546432905, 0.5),
            (0.9234613058044171, 0.4),
            (1.120095884939455, 0.3),
            (1.2480294533520828, 0.25),
            (1.4084773732193314, 0.2),
            (1.6216641718722455, 0.15),
            (1.9335970399474052, 0.1),
            (2.4933896422201745, 0.05),
            (3.0788875373138316, 0.025),
            (3.271562956722238, 0.02),
            (3.880096955171455, 0.01),
            (4.500596435921906, 0.005),
            (5.130106364876294, 0.0025),
            (5.334333565505318, 0.002),
            (5.972806258364118, 0.001),
            (6.616549310059811, 0.0005),
            (7.264645244923297, 0.00025),
            (7.474092513556307, 0.0002),
            (8.126903274775339, 0.0001),
            (8.782684288834432, 5e-05),
            (9.653472315459243, 2e-05),
            (10.314741851214647, 1e-05),
            (10.97792544385955, 5e-06),
            (11.857210143638701, 2e-06),
            (12.524139536504162, 1e-06),
        ),
        1.0006851391645355,
    )
    hold = True
    max_age = 1.0
    single = True
    axes = safeml.Axes(
        (
            # means
            (
                112.07767262268067,
                41.11341735712687,
                6.341233072439829,
                0.38312427334984145,
                0.021605031130506783,
                2.111026331419746,
            ),
            # divisors
            (
                14.112906934162462,
                6.254201272432192,
                1.1098865812858703,
                0.07151027637853417,
                0.1484748419729185,
                0.5887322739928856,
            ),
            # component 0
            (
                0.49853026142,
                0.534777455314,
                0.331437251992,
                0.493029937771,
                0.196580189529,
                0.271859723524,
            ),
            # component 1
            (
                -0.209594813478,
                -0.216130367518,
                0.119182080708,
                -0.247108021657,
                0.647276676896,
                0.64430104704,
            ),
            # component 2
            (
                -0.41490816203,
                0.200750296537,
                0.802064043816,
                -0.219848203398,
                -0.309511907058,
                0.010627887416,
            ),
        ),
        floor=6.467412784743845e-09,
    )
    # Rows: reference_sample.csv: 3000 rows, 6 features
    reference = safeml.Table(
        __spec__,
        "reference.bin",
        "b08e0a28bc30d36e10898a8e6faabbd32507fd2aef18ffd4f97a839b3da57435",
        (1500, 6),
    )
