"""A network's package as the tools of SESAME D7.2 wrote it (Figs 13 to 20)."""

from __future__ import annotations

from pathlib import Path

CONFIG = '''
from typing import Dict, Tuple


class BayesianNetworkConfig:
    """Bayesian network config to change the node's outcomes dependent
    on the received DRA data.
    """

    # ===== Initialization methods =====
    def __init__(self) -> None:
        self.dra_data = None

    # ===== Update methods =====
    def update_dra_data(self, dra_data) -> None:
        self.dra_data = dra_data

    # ===== Bayesian network's node methods =====
    def node_AV_Shuttle_Speed(self):
        is_bn_output = False
        outcome_NotDriving = 0.0
        outcome_range_0_to_2_kmh = 0.0
        outcome_range_2_to_4_kmh = 0.0
        outcome_more_than_4_kmh = 0.0
        """----------Manual edit begin----------"""
        kmh = self.to_kmh(self.dra_data.vehicleSpeed)
        if kmh < 0.05:
            outcome_NotDriving = 1.0
        elif kmh <= 2:
            outcome_range_0_to_2_kmh = 1.0
        elif kmh <= 4:
            outcome_range_2_to_4_kmh = 1.0
        else:
            outcome_more_than_4_kmh = 1.0
        """----------Manual edit end----------"""
        return is_bn_output, \\
               {'NotDriving': outcome_NotDriving,
                'range_0_to_2_kmh': outcome_range_0_to_2_kmh,
                'range_2_to_4_kmh': outcome_range_2_to_4_kmh,
                'more_than_4_kmh': outcome_more_than_4_kmh}

    def node_Distance_to_Pedestrian(self):
        is_bn_output = False
        outcome_range_0_to_1_m = 0.0
        outcome_range_1_to_2_m = 0.0
        outcome_more_than_2_m = 0.0
        # -----Manual edit begin-----
        pedestrian_distance = self.dra_data.pedestrianDistance
        if pedestrian_distance <= 1.0:
            outcome_range_0_to_1_m = 1.0
        elif 1.0 < pedestrian_distance <= 2.0:
            outcome_range_1_to_2_m = 1.0
        elif 2.0 < pedestrian_distance:
            outcome_more_than_2_m = 1.0
        # -----Manual edit end-----
        return is_bn_output, \\
               {'range_0_to_1_m': outcome_range_0_to_1_m,
                'range_1_to_2_m': outcome_range_1_to_2_m,
                'more_than_2_m': outcome_more_than_2_m}

    def node_Critical(self):
        is_bn_output = False
        outcome_Yes = 0.0
        outcome_No = 0.0
        \'\'\'-----Manual edit begin-----\'\'\'
        is_bn_output = True
        \'\'\'-----Manual edit end-----\'\'\'
        return is_bn_output, \\
               {'Yes': outcome_Yes,
                'No': outcome_No}

    def node_Gone(self):
        is_bn_output = False
        outcome_Yes = 0.0
        \'\'\'-----Manual edit begin-----\'\'\'
        outcome_Yes = 1.0  # of a node that is not in the network
        \'\'\'-----Manual edit end-----\'\'\'
        return is_bn_output, {'Yes': outcome_Yes}

    def to_kmh(self, value):
        return value * 3.6
'''


def write_old_network(folder: Path, xdsl: str, name: str = "PedestrianRisk") -> Path:
    """Write an old plain package with its network beside the configuration."""
    inner = folder / "files" / name
    inner.mkdir(parents=True)
    (inner / "bayesian_network_config.py").write_text(CONFIG, "utf-8")
    (inner / f"{name}.xdsl").write_text(xdsl, "utf-8")
    (folder / "bn_monitor.py").write_text("class BayesianNetworkMonitor:\n    pass\n", "utf-8")
    return folder
