"""What every model holds and keeps, whatever was done to it."""

from typing import Any

import numpy as np

from pinjoint.components.field import Role
from pinjoint.components.model import Model

Print = dict[str, Any]


def contents(model: Model) -> Print:
    """Everything that a model holds and that is not computed, bit for bit."""
    found: Print = {}
    for table in model.tables.values():
        found[table.name] = table.entities.tolist()
        for field in table.fields_in(Role.DOCUMENT, Role.STATE):
            column = table.storage(field.name)
            found[f"{table.name}.{field.name}"] = (
                column.tolist() if column.dtype == object else column.tobytes()
            )
    return found


def check_sound(model: Model) -> None:
    """The rules that every model keeps, whatever was done to it."""
    particles, rods, loads = model.particles, model.rods, model.loads
    for table in (particles, rods, loads, model.grids):
        assert len(set(table.names)) == table.count == len(table.handles)
        assert [handle.row for handle in table] == list(range(table.count))
        for field in table.fields_in(Role.DOCUMENT, Role.STATE):
            column = table.storage(field.name)
            if field.dtype is float and not field.nullable:
                assert np.isfinite(column).all(), (table.name, field.name)
    ends = rods.between.astype(np.int64)
    assert (ends < particles.count).all()
    assert (ends[:, 0] != ends[:, 1]).all()
    assert len({frozenset(pair) for pair in ends.tolist()}) == rods.count
    assert (loads.on < particles.count).all()
    assert (rods.rest_length > 0.0).all()
    assert (particles.mass > 0.0).all()
    assert (particles.velocity[particles.fixed] == 0.0).all()
    assert int(model.grids.shown.sum()) <= 1
