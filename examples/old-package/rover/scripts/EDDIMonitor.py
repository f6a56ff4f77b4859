class EDDIMonitor:

    def execute_step(self, eddi_input):
        active = eddi_input.Upright and eddi_input.StationIsFree
        return [{'id': 'MayDrive', 'active': active}]
