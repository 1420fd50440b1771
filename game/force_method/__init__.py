"""The force method: the guide through its seven parts, and their words."""

PARTS = 7
