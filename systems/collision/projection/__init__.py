"""Motion that no contact forbids."""
