"""Loads between the ends of rods, by dividing the rods where loads begin and end: then they act on joints and all along."""

import copy
from itertools import pairwise
from typing import Any

import numpy as np

Document = dict[str, Any]


def divided(document: Document, stiff: float = 1e3) -> tuple[Document, dict[str, list[tuple[float, str]]]]:
    """The same frame without loads between ends, and by the names of rods: from what distance on which part of it is which.

    stiff: EI of parts of bars, which do not bend, but hinged at both ends bear like simple beams.
    """
    made = copy.deepcopy(document)
    loads, rods = made.pop("span_loads"), made.pop("rods")
    place = {particle["name"]: np.array(particle["position"]) for particle in made["particles"]}
    made["rods"], parts = [], {}
    for rod in rods:
        own = [load for load in loads if load["rod"] == rod["name"]]
        first, last = (place[name] for name in rod["between"])
        way = last - first
        length = float(np.hypot(*way))
        inside = {
            x for load in own for x in (load.get("start", 0.0), load.get("end", length)) if 0.0 < x < length
        }
        cuts = [0.0, *sorted(inside), length]
        names = [rod["between"][0], *(f"{rod['name']} {i}" for i in range(1, len(cuts) - 1)), rod["between"][1]]
        for name, x in list(zip(names, cuts, strict=True))[1:-1]:
            made["particles"].append({"name": name, "position": (first + x / length * way).tolist()})
        joints = {particle["name"]: particle for particle in made["particles"]}
        axes = np.array([way, [-way[1], way[0]]]) / length
        for load in own:
            turn = axes if load.get("direction") == "local" else np.eye(2)
            joint = joints[names[cuts.index(load.get("start", 0.0))]]
            force = np.array(load.get("force", (0.0, 0.0))) @ turn
            joint["force"] = (np.array(joint.get("force", (0.0, 0.0))) + force).tolist()
            joint["moment"] = joint.get("moment", 0.0) + load.get("moment", 0.0)
        parts[rod["name"]] = []
        for i, (start, end) in enumerate(pairwise(cuts)):
            at = np.zeros((2, 2))
            for load in own:
                low, high = load.get("start", 0.0), load.get("end", length)
                turn = axes if load.get("direction") == "local" else np.eye(2)
                values = [
                    np.array(load.get(key, (0.0, 0.0))) @ turn for key in ("start_intensity", "end_intensity")
                ]
                if low <= start and end <= high:
                    at += [values[0] + (x - low) / (high - low) * (values[1] - values[0]) for x in (start, end)]
            part = rod | {"name": f"{rod['name']} {i}", "between": names[i : i + 2]}
            outer = (i == 0, end == length)
            bar = len(cuts) > 2 and rod.get("bending_stiffness", 0.0) == 0.0
            part["hinged"] = [a and (b or bar) for a, b in zip(outer, rod.get("hinged", (0, 0)), strict=True)]
            springs = zip(outer, rod.get("end_springs", (0.0, 0.0)), strict=True)
            part["end_springs"] = [spring * (at_joint and not bar) for at_joint, spring in springs]
            part |= {"bending_stiffness": stiff} if bar else {}
            part["distributed_force"] = (np.array(rod.get("distributed_force", (0.0, 0.0))) + at[0]).tolist()
            part["more_at_end"] = (at[1] - at[0]).tolist()
            made["rods"].append(part)
            parts[rod["name"]].append((start, part["name"]))
    return made, parts
