"""Perfect plasticity: strengths, yielding."""
