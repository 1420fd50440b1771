"""Input: the table of keys and buttons, and the window's events."""
