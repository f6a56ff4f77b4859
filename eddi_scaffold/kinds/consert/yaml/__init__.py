"""ConSerts from and to YAML."""
