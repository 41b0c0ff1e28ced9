"""Rows of plates: their values on public captures, and faults that break them."""

import numpy as np

from benchmarks.any_capture import plates
from benchmarks.any_capture.plates import clock_rows, encoding_rows, mass_rows, torque_rows, unreadable_rows


def test_small_public_files_keep_their_bounds(real_data):
    for rows in (encoding_rows, torque_rows, unreadable_rows):
        assert all(row.passed and np.isfinite(row.value) for row in rows(real_data))


def test_rows_of_masses_and_clocks(real_data, monkeypatch):
    some = {
        name: kg
        for name, kg in plates.KNOWN_KG.items()
        if "Static" in name or name.startswith("stoop_lift_box/neu")
    }
    monkeypatch.setattr(plates, "KNOWN_KG", some)
    monkeypatch.setattr(plates, "HEAVIER_KG", {"flywheel_squat/S1_FlywheelSquat.c3d": 81.3})
    assert all(row.passed for row in [*mass_rows(real_data), *clock_rows(real_data)])
    monkeypatch.setattr(plates, "KNOWN_KG", {name: 1.12 * kg for name, kg in some.items()})
    accused = next(row for row in mass_rows(real_data) if "accused" in row.name)
    assert accused.value == len(some) and not accused.passed
