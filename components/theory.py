"""The theories of statics: about the original positions, as in courses, or in exact geometry."""

THEORIES = FIRST_ORDER, EXACT = "first-order", "exact"
