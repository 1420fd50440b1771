"""Collisions of particles that rods, drag or laws of mods drive: they meet within the steps of an integrator."""
