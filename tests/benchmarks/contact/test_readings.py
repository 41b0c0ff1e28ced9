"""The rows of impossible readings: faults are what they say, changes are measured, and untold faults fail."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.contact import readings
from benchmarks.contact.readings import FAULTS, broken, curve_change, fault_rows, peak_change, refused
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.reconstruct import reconstruct
from tests.walker import walker

BY_NAME = {fault.name: fault for fault in FAULTS}


def test_a_fault_is_put_into_one_plate_in_its_stance():
    trial = walker().trial
    found = broken(trial, BY_NAME["one sample of 1e9 N"])
    changed = [k for k, (a, b) in enumerate(zip(found.plates, trial.plates, strict=True)) if a is not b]
    assert len(changed) == 1
    before, after = trial.plates[changed[0]].force_n, found.plates[changed[0]].force_n
    (sample,) = np.flatnonzero((before != after).any(axis=1))
    assert before[sample, 2] > 300.0
    assert after[sample, 2] == 1e9


@pytest.mark.parametrize("name", sorted(BY_NAME))
def test_every_fault_changes_readings(name):
    trial = walker().trial
    found = broken(trial, BY_NAME[name])
    assert any(
        not np.array_equal(a.force_n, b.force_n) for a, b in zip(found.plates, trial.plates, strict=True)
    )


def test_rows_pass_and_fail_where_nothing_is_cleaned(monkeypatch):
    trial, subject = walker().trial, walker().subject
    monkeypatch.setattr(readings, "FAULTS", (BY_NAME["twenty samples of 2e4 N"],))
    assert all(row.passed for row in fault_rows("walk", trial, subject, "kinematic"))
    monkeypatch.setattr("mbkf.trial.preparation.inputs.cleaned", lambda plates, _: (plates, ()))
    rows = {row.name: row for row in fault_rows("walk", trial, subject, "kinematic")}
    assert not any(row.passed for name, row in rows.items() if "told" in name or name.endswith("frames"))


def test_changes_are_those_that_were_made():
    trial, subject = walker().trial, walker().subject
    clean = reconstruct(trial, subject, settings=ReconstructSettings(filter="kinematic", smooth=False))
    assert peak_change(clean, clean, clean.tracked) == curve_change(clean, clean, clean.tracked) == 0.0
    larger = replace(clean, moments=1.1 * clean.moments)
    assert peak_change(clean, larger, clean.tracked) == pytest.approx(0.1)
    assert curve_change(clean, larger, clean.tracked) == pytest.approx(0.1)


def test_refused_samples_are_counted():
    trial, subject = walker().trial, walker().subject
    assert refused(iter([(trial.plates, subject.mass_kg)])) == 0.0
    found = broken(trial, BY_NAME["three samples of 4000 N"])
    assert refused(iter([(found.plates, subject.mass_kg)])) == 3.0
