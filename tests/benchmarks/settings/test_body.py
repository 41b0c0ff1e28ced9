"""A combination is asked for by preset and single settings."""

from benchmarks.settings.body import chosen
from mbkf.filters.torque.plant import Scheme


def test_a_combination_has_its_settings():
    found = chosen(("TF", "first", "van_loan", "true", "density", "inputs"))
    assert found.torque.scheme == Scheme("TF", "first", "van_loan", complete=True)
    assert (found.torque.plates, found.torque.noise, found.torque.per_frame) == (
        "inputs",
        "independent",
        False,
    )
    assert chosen(("FE", "second", "series", "false", "per frame", "sensors")).torque.per_frame
    assert chosen(("FE", "second", "series", "false", "stable", "sensors")).torque.noise == "consistent"
