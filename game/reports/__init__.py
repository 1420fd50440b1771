"""What the command line computes and prints, for one model at a time; `game.sweeps` does so for many."""
