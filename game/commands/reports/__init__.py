"""What commands compute and print for one model; `game.sweeps` does so for many."""
