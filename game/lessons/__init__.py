"""Lessons: the program asks, a student does, and the engine judges. assets/lessons/README.md is for teachers.

A lesson is a script (game/scripts/script.py) some of whose lines are tasks. `tasks` reads them; `judging` finds with the
engine whether a task is done, on a copy of the session where that takes a run; a `Course` is a lesson in a session, of
which a window shows the card (components/view.py); `progress` keeps what a person did; `checking` plays a lesson without
a window, with its solutions and its wrong answers, for `pinjoint play`.

A task asks for one of four things:

* a state ("until"): whatever way leads there is right, since only the model is looked at, whenever it stands still;
* a selection ("select"): the elements to select are those that the engine finds;
* a number ("number"): that which the engine reads, perhaps after a run or settling of a copy ("after");
* a choice ("choices"): those are right whose conditions hold there.

The model of a task belongs to the lesson: it asks for no saving, and the person's own document stays open below it.
"""
