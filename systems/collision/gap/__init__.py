"""When two discs meet."""
