"""See kernels."""
