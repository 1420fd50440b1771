"""A run: one model on its way through time, by a step program or by exact flight."""
