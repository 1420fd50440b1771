"""The system of phase STEP: time passes."""

from __future__ import annotations

from typing import Any

from pinjoint.systems.base import Phase, System


class Time(System):
    """Lets the time of one frame pass in the model that is open: as many steps as its pace and the machine allow.

    The laws, commits and the integrator that act in the scene take these steps, as one compiled program.
    """

    name = "run.time"
    phase = Phase.STEP
    scenes = ("simulation",)
    reads = ("document", "pace")
    writes = ("state",)

    def process(self, frame: Any) -> None:
        """Take the steps of the frame, by the plan of its scene as the model is in each of them.

        While a script is shown in a window, only its own lines let time pass.
        """
        session, document = frame.session, frame.session.document
        if session.footer is not None:
            return
        document.simulation.act_in(frame.scene)
        document.note_beginning()
        if document.simulation.halted or not session.readiness.lets(document.simulation):
            return
        with document.timeline.recording():
            document.live.frame(frame.elapsed)
        document.chronicle.look()
