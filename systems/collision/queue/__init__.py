"""Which meeting comes first."""
