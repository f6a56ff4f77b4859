"""Pictures of models: what to draw, a layered layout of it, and SVG; no tool is needed."""
