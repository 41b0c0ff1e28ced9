"""Faults of the benchmark of verdicts change what they name, and nothing else."""

from pathlib import Path

import numpy as np

from benchmarks.verdict.trials import AnotherPerson, Exchanged, Turned, shown_faulty, shown_right
from mbkf.trial.synth import synthesise


def test_plates_are_turned_and_the_person_stays():
    subject, made = synthesise("walk", seconds=1.0, seed=1)
    turned, same, _ = Turned(2).put_into(made.trial, subject)
    assert same is subject and turned.markers is made.trial.markers
    for plate, before in zip(turned.plates, made.trial.plates, strict=True):
        np.testing.assert_allclose(plate.force_n[:, :2], -before.force_n[:, :2], atol=1e-9)
        np.testing.assert_allclose(plate.force_n[:, 2], before.force_n[:, 2])


def test_names_are_exchanged_and_persons_too():
    subject, made = synthesise("walk", seconds=1.0, seed=1)
    names = made.trial.markers.names
    crossed, _, _ = Exchanged(("RKNE", "LKNE")).put_into(made.trial, subject)
    assert crossed.markers.names.index("LKNE") == names.index("RKNE")
    assert set(crossed.markers.names) == set(names)
    _, other, _ = AnotherPerson(11).put_into(made.trial, subject)
    assert other.mass_kg != subject.mass_kg


def test_no_shown_trial_is_one_that_bounds_were_set_on():
    seeds = {one.seed for one in (*shown_right(Path()), *shown_faulty(Path()))}
    assert seeds.isdisjoint({0, 1, 2})
