"""Checks of ConSerts: what is wrong with a model by itself."""
