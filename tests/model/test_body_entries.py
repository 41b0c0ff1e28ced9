"""The names of a body file's entries are those that bodies use."""

import tomllib
from pathlib import Path

from mbkf.model.body_entries import KNOWN, OPTIONAL, SEGMENT_KEYS

MODELS = Path(__file__).resolve().parents[2] / "models"


def test_every_table_that_is_named_exists():
    tables = {name.split(".")[0] for name in KNOWN if name}
    assert tables <= set(KNOWN[""])
    assert set(OPTIONAL) < set(SEGMENT_KEYS)


def test_the_reference_body_uses_no_other():
    table = tomllib.loads((MODELS / "human18.toml").read_text("utf-8"))
    assert set(table) <= set(KNOWN[""])
    needed = set(SEGMENT_KEYS) - set(OPTIONAL)
    assert all(needed <= set(segment) for segment in table["segment"])
