"""The force method and the displacement method: the guides through their parts, with words, tables and reports."""

PARTS = 7  # of the force method
_BELOW = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")


def index(*numbers: int) -> str:
    """Indices as they stand below: "₁₀"; apart from each other if one has two digits."""
    return ("" if max(numbers) < 10 else "\u2009").join(str(number).translate(_BELOW) for number in numbers)
