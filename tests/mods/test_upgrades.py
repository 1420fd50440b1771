"""Data of mods in files: written with the version of the mod, and brought up to date by later versions."""

import json
from pathlib import Path
from typing import Any

import pytest

from pinjoint import Session, mods
from pinjoint.documents import models
from pinjoint.documents.models import ModelError
from tests.reference.models import model, particle

CHARGE = """
from pinjoint.components import Component, Field, Handle, Particle

class Charge(Component):
    of = Particle
    {field}: Field[float] = Field("C", title="charge", doc="Of it.")

class Plate(Handle):
    table, noun = "plates", "plate"
    name: Field[str] = Field(dtype=str, doc="Unique.")

{upgrade}

def plugin(app):
    app.component(Charge)
    app.kind(Plate)
    {register}
"""
UPGRADE = """
def upgrade(document, version):
    for particle in document["particles"]:
        data = particle.get("components", {}).get("charge.Charge", {})
        if "amount" in data:
            data["value"] = data.pop("amount") * (1.0 if version else 1e-3)
"""
BALL: dict[str, Any] = model([particle("A", 0, 0)], [])


@pytest.fixture
def charge(tmp_path: Path, unloaded: None) -> Any:
    """Load a version of the mod in place of the one before."""

    def load(version: str, field: str, upgrade: str = "") -> Path:
        mods.unload([mod for mod in mods.MODS if mod.name == "charge"])
        folder = tmp_path / version / "charge"
        folder.mkdir(parents=True)
        code = CHARGE.format(field=field, upgrade=upgrade, register="app.upgrade(upgrade)" if upgrade else "")
        (folder / "__init__.py").write_text(code, encoding="utf-8")
        (folder / "mod.toml").write_text(f'name = "charge"\nversion = "{version}"\n', encoding="utf-8")
        mods.load_all([folder])
        return folder

    return load


def saved(session: Session, path: Path) -> dict[str, Any]:
    session.save(path)
    document: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return document


def test_a_renamed_field_opens_old_files(charge: Any, tmp_path: Path) -> None:
    charge("1.0", "amount")
    session = Session.open(BALL)
    assert "mods" not in saved(session, tmp_path / "without.json")  # it has no data of the mod
    session.particles["A"].charge_amount = 2.5  # type: ignore[attr-defined]
    old = tmp_path / "old.json"
    assert saved(session, old)["mods"] == {"charge": "1.0"}

    charge("1.1", "value", UPGRADE)
    again = Session.open(old)
    assert again.particles["A"].charge_value == 2.5  # type: ignore[attr-defined]
    assert saved(again, tmp_path / "new.json")["mods"] == {"charge": "1.1"}
    assert Session.open(tmp_path / "new.json").particles["A"].charge_value == 2.5  # type: ignore[attr-defined]


def test_files_that_do_not_say_their_version_are_upgraded_too(charge: Any) -> None:
    charge("1.1", "value", UPGRADE)
    data = {"charge.Charge": {"amount": 5.0}}
    document = {**BALL, "particles": [{**BALL["particles"][0], "components": data}]}
    assert Session.open(document).particles["A"].charge_value == 5e-3  # type: ignore[attr-defined]
    assert data == {"charge.Charge": {"amount": 5.0}}  # what was given stays as it is


def test_without_the_mod_data_and_version_are_kept(charge: Any, tmp_path: Path) -> None:
    charge("1.0", "amount")
    session = Session.open(BALL)
    session.particles["A"].charge_amount = 2.5  # type: ignore[attr-defined]
    written = saved(session, tmp_path / "old.json")
    mods.unload([mods.MODS[-1]])
    assert saved(Session.open(tmp_path / "old.json"), tmp_path / "again.json") == written


def test_newer_files_are_left_alone(charge: Any) -> None:
    charge("1.1", "value", "def upgrade(document, version):\n    1 / 0")
    kinds = {"charge.Plate": [{"name": "p"}]}
    document = {**BALL, "components": kinds, "mods": {"charge": "2.0"}}
    assert Session.open(document).table("plates")["p"]


def test_an_upgrade_that_fails_is_told_and_loses_nothing(charge: Any) -> None:
    charge("1.1", "value", "def upgrade(document, version):\n    1 / 0")
    document = {**BALL, "components": {"charge.Plate": [{"name": "p"}]}, "mods": {"charge": "1.0"}}
    with pytest.raises(
        ModelError, match=r"\$\.mods: the data of charge 1\.0 could not be upgraded; --no-mods opens"
    ):
        models.load(document)
    assert "ZeroDivisionError" in mods.MODS[-1].problem
    mods.unload([mods.MODS[-1]])
    assert models.document(models.load(document)) == {
        **models.document(models.load(BALL)),
        **{key: document[key] for key in ("components", "mods")},
    }


@pytest.mark.parametrize(
    ("stated", "said"),
    [
        (["charge"], "must be an object such as"),
        ({"charge": 1}, "charge is 1; write it like"),
        ({"charge": "x"}, "write it like"),
    ],
)
def test_versions_that_are_none_are_refused(stated: Any, said: str) -> None:
    with pytest.raises(ModelError, match=said):
        models.load({**BALL, "mods": stated})
