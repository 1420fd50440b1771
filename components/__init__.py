"""DATA: what an entity is. No pygame, no numba, no behaviour."""
