"""Typing into boxes: what each accepts, its caret, and moving from box to box."""

from __future__ import annotations

import re
from collections.abc import Sequence

from pinjoint.components.form import FILE_NAME, NAME, NUMBER, TEXT, Box, Form, fits_file_names
from pinjoint.components.language import joined, marked, tr
from pinjoint.components.units import begins
from pinjoint.components.wording import cut

YES_NO = (marked("no"), marked("yes"))
MOST_CHARACTERS = 200  # in one box

_MEANS = {"0": "no", "1": "yes"}
_DIGITS = r"-?(\d+\.?\d*|\.\d*)?"  # a number, or the beginning of one
_NUMBER_SO_FAR = re.compile(rf"{_DIGITS}|-?(\d+\.?\d*|\.\d+)[eE][+-]?\d*")
# A number with a unit of its own, known if nothing parts the two, or the beginning of one.
_WITH_UNIT_SO_FAR = re.compile(r"-?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?( ?)([^\d\s.,eE][^,]*|)")
# Other keyboards, numbers copied from the screen, the notation of the thesis.
_IN_NUMBERS = {",": ".", "−": "-", "/": "-"}


class Typing:
    """Typing into the boxes of a form."""

    def __init__(self, form: Form) -> None:
        self.form = form

    def select(self, box: Box | None) -> None:
        """Select a box, all its text marked; None: select none."""
        if self.form.selected is not None:
            self.form.selected.marked = False
        self.form.selected = box
        if box is not None:
            box.held = box.text
            self.mark_all()

    def restore(self) -> str:
        """Restore the former text of the selected box, and deselect it; returns the sentence that says what was given up."""
        box = self.form.selected
        if box is None:
            return ""
        typed, changed = box.said_text, box.text not in ("", box.held)
        self.put(box, box.held)
        self.select(None)
        if not changed:
            return ""
        if box.text:
            told = tr(
                "“{typed}” was discarded; {title} is still {value}.",
                typed=typed,
                title=box.said_title,
                value=box.said_text,
            )
        else:
            told = tr("“{typed}” was discarded; {title} is as before.", typed=typed, title=box.said_title)
        return joined([told, tr("Press Return to accept what you typed.")])

    def accept(self) -> bool:
        """Deselect the selected box; False if its text is refused, and then it stays selected."""
        box = self.form.selected
        if box is not None and box.problem:
            return False
        self.select(None)
        return True

    def move_on(self, by: int) -> None:
        """Select the next (1) or previous (-1) box, around the ends."""
        if self.form.boxes:
            start = (
                (-1 if by > 0 else 0)
                if self.form.selected is None
                else self.form.boxes.index(self.form.selected)
            )
            self.select(self.form.boxes[(start + by) % len(self.form.boxes)])

    def write(self, text: str) -> str:
        """Type characters into the selected box; those that it does not accept are passed over.

        Returns the sentence that says which a box for a number passed over, such as a unit of another size; else "".
        """
        box, refused = self.form.selected, ""
        if box is None:
            return ""
        for character in text:
            entered = _entered(box, character)
            if entered is not None and len(entered[0]) <= MOST_CHARACTERS:
                self.put(box, *entered)
            elif not character.isspace():
                refused += character
        if not refused or box.accepts != NUMBER:
            return ""
        if box.unit:
            told = tr(
                "Type a number in {unit}, such as 2.5 or 1e3, without “{refused}”.",
                unit=box.unit,
                refused=cut(refused),
            )
        else:
            told = tr("Type a number, such as 2.5 or 1e3, without “{refused}”.", refused=cut(refused))
        return joined(
            [told, *(tr("“{word}” is possible, too.", word=box.said_word(word)) for word in box.words)]
        )

    def erase(self, *, after: bool = False) -> None:
        """Erase the marked text, or the character before (or after) the caret."""
        box = self.form.selected
        if box is None:
            return
        text, caret = box.text, box.caret
        if box.marked or text in box.words:
            self.put(box, "", 0)
        elif after:
            self.put(box, text[:caret] + text[caret + 1 :], caret)
        elif caret:
            self.put(box, text[: caret - 1] + text[caret:], caret - 1)

    def place_caret(self, caret: int) -> None:
        """Put the caret of the selected box behind a number of characters, and mark nothing."""
        box = self.form.selected
        if box is not None:
            box.caret = min(max(caret, 0), len(box.said_text))
            box.marked = False

    def step_caret(self, by: int) -> None:
        """Move the caret by one character, or to the end of the marked text."""
        box = self.form.selected
        if box is not None and box.marked:
            self.place_caret(len(box.said_text) if by > 0 else 0)
        elif box is not None:
            self.place_caret(box.caret + by)

    def mark_all(self) -> None:
        """Mark all text of the selected box."""
        box = self.form.selected
        if box is not None:
            box.caret = len(box.text)
            box.marked = True

    def turn_word(self, box: Box, by: int = 1) -> None:
        """Put the next (or previous) of its words into a box."""
        words = box.words
        at = words.index(box.text) if box.text in words else -1 if by > 0 else 0
        word = words[(at + by) % len(words)]
        self.put(box, word)
        box.marked = True

    def put(self, box: Box, text: str, caret: int | None = None) -> None:
        """Replace all text of a box; caret: behind how many characters it stands, if not at the end."""
        box.text = text
        box.caret = len(text) if caret is None else caret
        box.marked = False
        box.problem = self.form.check(box)


# --- what is accepted --------------------------------------------------------------------------------


def _entered(box: Box, character: str) -> tuple[str, int] | None:
    """Text and caret after a character was typed; None if the box does not accept it."""
    words = box.words
    whole = box.marked or (box.text in words and box.accepts != NAME)
    held = box.said_text if box.accepts == NAME else box.text  # numbers are held with a point
    before, after = ("", "") if whole else (held[: box.caret], held[box.caret :])
    after = "" if box.accepts == NAME and box.text in words else after
    if box.accepts == NUMBER:
        if box.unit and _has_unit(before + character + after):
            return before + character + after, len(before) + 1
        before, character = before.removesuffix(" "), _IN_NUMBERS.get(character, character)
        if _NUMBER_SO_FAR.fullmatch(before + character + after):
            return before + character + after, len(before) + 1
    elif box.accepts == TEXT and character.isprintable():
        return before + character + after, len(before) + 1
    elif box.accepts == FILE_NAME:
        character = character.replace("/", "-")
        if fits_file_names(character):
            return before + character + after, len(before) + 1
    completed = _completed(box, words, character)
    if completed is None and box.accepts == NAME and character.isprintable():
        return before + character + after, len(before) + 1
    return completed


def _has_unit(text: str) -> bool:
    found = _WITH_UNIT_SO_FAR.fullmatch(text)
    return found is not None and text.isprintable() and (found[3] != "" or begins(found[4]))


def _completed(box: Box, words: Sequence[str], character: str) -> tuple[str, int] | None:
    """The word whose beginning was typed, in the present language or in English, and the number of typed characters."""
    so_far = "" if box.marked or not (box.text in words or box.accepts == NAME) else box.said_text[: box.caret]
    alone = () if box.accepts == NAME and so_far else (character,)
    for typed in (so_far + character, *alone):
        meant = _MEANS.get(typed, typed).lower() if words == YES_NO else typed.lower()
        for word in words:
            if any(said.lower().startswith(meant) for said in (box.said_word(word), word)):
                return word, len(meant)
    return None
