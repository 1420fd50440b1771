"""Mods bring their own catalogues, which hold what ours do not."""

from pathlib import Path

import pytest

from pinjoint import mods
from pinjoint.components.language import spoken, tr
from pinjoint.editor.readouts import readouts
from pinjoint.session import Session
from tests.catalogues import MODS

WIND = MODS / "wind"


def test_what_a_mod_says_is_translated_while_it_is_loaded(unloaded):
    session = Session.open("isostatic", mods=[WIND])
    with spoken("pt"):
        (panel,) = (readout for readout in readouts(session) if readout.title == "Vento")
        assert panel.rows == (("velocidade", "0 m/s"),)
        session.environment.wind_velocity = (0.5, 0.0)  # type: ignore[attr-defined]
        (panel,) = (readout for readout in readouts(session) if readout.title == "Vento")
        assert panel.rows == (("velocidade", "0,5 m/s"),)
        assert tr("wind velocity") == "velocidade do vento"
        mods.unload([mod for mod in mods.MODS if mod.name == "wind"])
        assert tr("wind velocity") == "wind velocity"


def test_the_catalogue_of_a_mod_is_there_whichever_language_is_chosen_later(unloaded):
    with spoken("pt"):
        mods.load([WIND])
        assert tr("sail area") == "área da vela"
    assert tr("sail area") == "sail area"
    with spoken("pt"):
        assert tr("sail area") == "área da vela"


def test_our_catalogue_goes_before_those_of_mods(unloaded, write_mod):
    folder = write_mod("loud")
    place = folder / "locale" / "pt" / "LC_MESSAGES"
    place.mkdir(parents=True)
    compile_catalogue({"options": "LOUD", "loud words": "palavras"}, place / "loud.mo")
    mods.load([folder])
    with spoken("pt"):
        assert tr("options") == "opções"
        assert tr("loud words") == "palavras"


def compile_catalogue(messages: dict[str, str], path: Path) -> None:
    from babel.messages.catalog import Catalog
    from babel.messages.mofile import write_mo

    catalogue = Catalog(locale="pt")
    for message, said in messages.items():
        catalogue.add(message, said)
    with path.open("wb") as file:
        write_mo(file, catalogue)


@pytest.mark.parametrize("damaged", [b"", b"nonsense", b"\xde\x12\x04\x95" + bytes(8)])
def test_a_damaged_catalogue_leaves_the_mod_out_and_says_where(unloaded, write_mod, damaged):
    folder = write_mod("torn")
    place = folder / "locale" / "pt" / "LC_MESSAGES"
    place.mkdir(parents=True)
    (place / "torn.mo").write_bytes(damaged)
    (mod,) = (mod for mod in mods.load([folder]) if mod.name == "torn")
    assert mod.off
    assert "torn.mo cannot be read; compile it again." in mod.problem
    with spoken("pt"):
        assert tr("options") == "opções"
