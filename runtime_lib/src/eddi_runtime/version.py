"""The version of this runtime, which a model file can ask for."""

__version__ = "0.1.0"
