"""Hand edits in generated files survive every regeneration.

Standard library only: the package runs from a template checkout (``python
<checkout>/eddi_scaffold/regions sync``) on machines that have nothing but Copier.
"""
