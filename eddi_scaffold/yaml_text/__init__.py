"""YAML with positions: nodes that know their line and column, texts that are replaced in place."""
