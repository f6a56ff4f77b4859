"""motor_watch: compiled by eddi-scaffold, do not edit.

Model: motor_watch.events
"""

from . import eddi_runtime
from .eddi_runtime import InputSpec, event, expressions

eddi_runtime.needs(__file__, {eddi_runtime: 1, event: 1, expressions: 1})
# sha256 of the lines below: d452999aa36099968ad0620e21ad31991442b3735a4bcbdad1a7a96187a066ba
NAN = float("nan")


class Monitor(event.EventMonitor):
    model_id = "motor_watch"
    digest = "74032a235bcc38fc181c5121afdddc85bb35cb87243e68c90d2467d3e9f98bc9"
    inputs = (
        InputSpec("temp", "temp", requires=("temperature",), max_age=0.5),
        InputSpec("current", "current", requires=("current",), max_age=0.5),
    )
    types = ("number", "number")
    events = (event.Event("MotorFit", False, (0, 1)),)

    def __init__(self):
        self.windows = (
            expressions.stacks.Average(2000000000, 1900000000, 64),  # 7:5 AVERAGE(temp, 2 s)
            expressions.windows.Hold(2000000000, 1900000000, 2),  # 8:13 ONCE(temp > 80, 2 s)
            expressions.windows.Hold(1000000000, 900000000, 0),  # 9:9 TIME(current < 12, 1 s)
        )
        self.w1 = self.windows[0].push
        self.w6 = self.windows[1].push
        self.w12 = self.windows[2].push
        super().__init__()

    def step(self, source, t):
        try:
            raw = (source.temp, source.current)
        except Exception:
            raw = self.read(source)
        self.raw = raw
        temp, current = raw
        temp_stamp = self.stamp(t, "temp")
        current_stamp = self.stamp(t, "current")
        last = self.last
        if last is not None and t > last:
            if 2 * (t - last) > 500000000:  # a gap: windows fill again
                self.since = t
        elif t == last:
            return self.outputs
        else:
            self.restart()
            self.since = t
        self.last = t
        age = t - self.since
        if type(temp) is not float:
            temp = expressions.number(temp)
        if not -40.0 <= temp <= 200.0:
            temp = NAN
        if temp_stamp > t:
            if temp_stamp - t > 100000000:
                temp = NAN
            temp_stamp = t
        if t - temp_stamp > 500000000:
            temp = NAN
        if type(current) is not float:
            current = expressions.number(current)
        if not current - current == 0.0:
            current = NAN
        if current_stamp > t:
            if current_stamp - t > 100000000:
                current = NAN
            current_stamp = t
        if t - current_stamp > 500000000:
            current = NAN
        r1 = self.w1(t, age, temp)  # 7:5 AVERAGE(temp, 2 s)
        r3 = 2 if r1 < 70.0 else 0 if r1 >= 70.0 else 1  # 7:23 AVERAGE(temp, 2 s) < 70
        r5 = 2 if temp > 80.0 else 0 if temp <= 80.0 else 1  # 8:23 temp > 80
        r6 = self.w6(t, age, r5)  # 8:13 ONCE(temp > 80, 2 s)
        r7 = 2 - r6  # 8:9 NOT ONCE(temp > 80, 2 s)
        r8 = r3 if r3 < r7 else r7  # 8:5 (AVERAGE(temp, 2 s) < 70) AND NOT ONCE(temp > 80, 2 s)
        r11 = 2 if current < 12.0 else 0 if current >= 12.0 else 1  # 9:22 current < 12
        r12 = self.w12(t, age, r11)  # 9:9 TIME(current < 12, 1 s)
        # 9:5 ((AVERAGE(temp, 2 s) < 70) AND NOT ONCE(temp > 80, 2 s)) AND TIME(c...
        r13 = r8 if r8 < r12 else r12
        outputs = (r13,)
        self.outputs = outputs
        return outputs
