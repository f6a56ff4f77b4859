"""Packages made by the tools of SESAME D7.2 become ours, with every hand-written line."""
