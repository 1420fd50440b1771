"""The force method: the guide through its seven parts, and their words."""

PARTS = 7
_BELOW = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")


def index(*numbers: int) -> str:
    """Indices as they stand below: "₁₀"; apart from each other if one has two digits."""
    return ("" if max(numbers) < 10 else "\u2009").join(str(number).translate(_BELOW) for number in numbers)
