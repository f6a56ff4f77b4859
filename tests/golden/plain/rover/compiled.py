"""rover: compiled by eddi-scaffold, do not edit.

Model: rover.yml
"""

from . import eddi_runtime
from .eddi_runtime import InputSpec, consert

eddi_runtime.needs(__file__, {eddi_runtime: 1, consert: 1})
# sha256 of the lines below: a12440685af4361217fd1dd4601a0ca094388e11cd9100ef7f7a571c52bd750d
INF = float("inf")


class Monitor(consert.ConSert):
    model_id = "rover"
    digest = "3a7e8af40cdbbf6e9abf97312332153b38daaee3b24fa202250b9b94f3ec0f15"
    inputs = (
        InputSpec("MapKnown", "MapKnown", requires=("MapKnown",)),
        InputSpec("Distance", "Distance", requires=("Distance",)),
        InputSpec("2nd sensor-ok", "_2nd_sensor_ok", requires=("2nd sensor-ok",)),
        InputSpec("class", "class_", requires=("class",)),
        InputSpec("Mode", "Mode", requires=("Mode",)),
    )
    leaves = (
        consert.Binary(),
        consert.Numeric(((2.5, INF, True),), "[2.50, inf] m"),
        consert.Binary(),
        consert.Binary(),
        consert.Categorical("crawl", "no"),
    )
    # Name, gate, numbers of what it reads: the inputs first, then these nodes.
    nodes = (
        ("All", "And", (1, 2, 0)),  # 5
        ("StandStill", "And", ()),  # 6
        ("Any", "Or", (3, 4, 5)),  # 7
        ("FastDrive", "And", (5,)),  # 8
        ("SlowDrive", "And", (7,)),  # 9
    )
    guarantees = (
        consert.Guarantee("FastDrive", 8, ranking=2),
        consert.Guarantee("SlowDrive", 9, ranking=1),
        consert.Guarantee("StandStill", 6, default=True),
    )
    services = (("Driving", ("FastDrive", "SlowDrive", "StandStill")),)

    def step(self, source):
        try:
            raw = (
                source.MapKnown,
                source.Distance,
                source._2nd_sensor_ok,
                source.class_,
                source.Mode,
            )
        except Exception:
            raw = self.read(source)
        self.raw, self.source = raw, source
        MapKnown, Distance, v2, v3, Mode = raw
        # MapKnown
        if MapKnown is True:
            MapKnown = 2
        else:
            MapKnown = 0 if MapKnown is False else self.judge(0, MapKnown)
        # Distance
        if type(Distance) is float or type(Distance) is int:
            if 2.5 <= Distance <= INF:
                Distance = 2
            else:
                Distance = 0 if Distance == Distance else 1  # NaN is unknown
        else:
            Distance = self.judge(1, Distance)
        # 2nd sensor-ok
        if v2 is True:
            v2 = 2
        else:
            v2 = 0 if v2 is False else self.judge(2, v2)
        # class
        if v3 is True:
            v3 = 2
        else:
            v3 = 0 if v3 is False else self.judge(3, v3)
        # Mode
        if type(Mode) is str:
            Mode = 2 if Mode in {"crawl", "no"} else 0
        else:
            Mode = self.judge(4, Mode)
        # And All
        All = Distance if Distance < v2 else v2
        if MapKnown < All:
            All = MapKnown
        # Or Any
        Any = v3 if v3 > Mode else Mode
        if All > Any:
            Any = All
        return (
            All == 2,  # FastDrive
            Any == 2,  # SlowDrive
            2 == 2,  # StandStill
        )

    def execute_step(self, source, t_ns=None):
        FastDrive, SlowDrive, StandStill = self.step(source)
        return [
            {"id": "FastDrive", "active": FastDrive},
            {"id": "SlowDrive", "active": SlowDrive},
            {"id": "StandStill", "active": StandStill},
        ]
