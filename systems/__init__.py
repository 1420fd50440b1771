"""BEHAVIOUR: what happens to entities, one folder per domain."""
