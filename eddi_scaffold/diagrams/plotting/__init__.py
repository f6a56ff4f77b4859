"""Plots of a run over time as SVG, without a plotting library."""
