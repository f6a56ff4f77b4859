"""Turn design-time EDDIs into runtime monitors, and keep regenerating them."""

__version__ = "0.1.0"
