"""What commands compute and print for one model; `pinjoint.sweeps` does so for many."""
