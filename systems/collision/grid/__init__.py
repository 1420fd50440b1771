"""Which discs can meet at all."""
