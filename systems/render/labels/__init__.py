"""Labels: where values and names stand, nearer to their own than to all else."""
