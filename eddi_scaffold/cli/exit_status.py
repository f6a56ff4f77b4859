"""Meaning of the exit status of a command."""

NO = 1  # the answer is no: problems were found, packages are not up to date
BAD_INPUT = 2  # the input cannot be used; nothing was done
LOOK = 3  # done, but a person should look at what is left
OUR_BUG = 70
INTERRUPTED = 130
