"""A view of a fleet: what its monitors publish, which guarantees are active, and why not."""
