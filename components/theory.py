"""The theories of statics: about the original positions, as in courses, or in exact geometry."""

from pinjoint.components.language import marked

THEORIES = FIRST_ORDER, EXACT = marked("first-order"), marked("exact")
NAMES = {FIRST_ORDER: marked("first order"), EXACT: marked("exact geometry")}
