import math

LIMIT = 20  # degrees; the wheels lift at 28


def tilt(q):
    return math.degrees(math.acos(1 - 2 * (q.x ** 2 + q.y ** 2)))


class EDDIInput:

    def __init__(self):
        self.Upright = False
        self.StationIsFree = False

    def process_Upright(self, imu):
        '''-----Manual edit begin-----'''
        self.Upright = tilt(imu.orientation) < LIMIT
        '''-----Manual edit end-----'''

    def process_StationIsFree(self, station):
        '''-----Manual edit begin-----'''
        for guarantee in station.guarantees:
            if guarantee.id == 'IsFree':
                self.StationIsFree = guarantee.active
        '''-----Manual edit end-----'''

    def processing(self, simulator_outputs):
        if 'imu' in simulator_outputs:
            self.process_Upright(simulator_outputs['imu'])
        if 'station' in simulator_outputs:
            self.process_StationIsFree(simulator_outputs['station'])
