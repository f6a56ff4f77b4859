"""What kinds share to write ``compiled.py``, and monitors in C99 or Python without a runtime."""
