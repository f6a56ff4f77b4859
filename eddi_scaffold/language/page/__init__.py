"""The Event Creator page of SESAME D7.2 Fig 24: served on this machine only, nothing from outside.

One HTML form, rendered here; it works without JavaScript, which only adds copying, Ctrl+Enter and
the caret at an error.
"""
