"""ConSerts from EDDI XML."""
