"""Mechanics of rods and particles: laws, integrators, and the steps and pace that suit a model."""
