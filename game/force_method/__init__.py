"""The force method: its guide, the words it is told in, and its report without a window."""

PARTS = 7
