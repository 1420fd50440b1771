"""The pictures of examples show what the program computes now."""

import json

import numpy as np
import pytest

from pinjoint.documents import models
from tests.golden.previews import FILE, preview_of

QUICK = ("isostatic", "warren_bridge", "staircase", "pendulum")  # the others take as long again as all these
CLOSE = 2e-3  # of the largest of a kind: less than a pixel of a picture


@pytest.mark.parametrize("name", QUICK)
def test_a_preview_is_up_to_date(name: str) -> None:
    kept, now = json.loads(FILE.read_text("utf-8"))[name], preview_of(name)
    assert kept.keys() == now.keys()
    for column, values in now.items():
        new = np.array(values)
        assert np.array(kept[column]) == pytest.approx(new, abs=CLOSE * np.abs(new).max()), column


def test_only_examples_have_previews() -> None:
    assert json.loads(FILE.read_text("utf-8")).keys() <= {*models.bundled()}
