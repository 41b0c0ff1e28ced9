"""Electromyograms by cycle: the trial's own numbers, activity, and the reference of 100 %."""

import numpy as np
import pytest

from mbkf.errors import UnknownName
from mbkf.study.session.comparison import compare
from mbkf.study.session.cycles import Key
from mbkf.study.session.emg import muscle_cycles, muscles
from mbkf.study.session.gather import session_of
from mbkf.study.session.tables import curves_table
from mbkf.trial.gait.cycles import over_cycle
from tests.study.session.emg import mixed, with_muscles
from tests.study.session.sessions import session, walks

SOLEUS = Key("emg", "soleus")


def both():
    return session_of(mixed(), "x")


def test_each_side_has_its_own_muscle_over_its_own_cycles():
    one, made = mixed()[0], both()
    for side, column in zip(made.gaits[0].sides, (0, 1), strict=True):
        for k, cycle in enumerate(side.cycles):
            values = side.curves[SOLEUS].values[k]
            if cycle.trial == one.trial:
                own = over_cycle(one.times_s, one.emg_envelope[:, column], cycle.cycle)
                np.testing.assert_allclose(values, own)
            else:
                assert np.isnan(values).all()
        assert Key("emg", "emg_3") in side.curves and Key("emg", "soleus_l") not in side.curves
    assert muscles(made.gaits[0]) == ("soleus", "emg_3")


def test_activity_is_that_of_the_bursts():
    right, left = both().gaits[0].sides
    first = next(c.cycle for c in right.cycles)
    at = np.linspace(first.start_s, first.end_s, 101)
    active = right.curves[Key("emg_active", "soleus")].values[0]
    np.testing.assert_array_equal(active, (at >= 1.0) & (at <= 2.0))
    assert 0.0 < active.mean() < 1.0
    assert np.nansum(left.curves[Key("emg_active", "soleus")].values) == 0.0


def test_a_trial_without_electromyograms_keeps_its_other_curves():
    plain, made = session_of(walks(), "x"), both()
    for side, other in zip(made.gaits[0].sides, plain.gaits[0].sides, strict=True):
        assert {key for key in side.curves if not key.is_emg} == set(other.curves)


def test_hundred_per_cent_is_the_peak_the_mean_or_a_trial():
    made = both()
    gait = made.gaits[0]
    raw = gait.sides[0].curves[SOLEUS].values
    for reference, over in (("peak", np.nanmax(raw)), ("mean", np.nanmean(raw))):
        right, left = muscle_cycles(made, gait, "soleus", reference)
        np.testing.assert_allclose(right.percent, 100.0 * raw / over)
        assert (right.side, left.side) == (0, 1)
    right, _ = muscle_cycles(made, gait, "soleus", "walk 0")
    np.testing.assert_allclose(right.percent, 100.0 * raw / mixed()[0].emg_envelope[:, 0].max())
    with pytest.raises(UnknownName, match="walk 1"):
        muscle_cycles(made, gait, "soleus", "walk 1")


def test_curves_are_exported_and_never_compared():
    made = both()
    table = curves_table(made).to_pydict()
    assert {"emg", "emg_active"} <= set(table["quantity"])
    louder = session_of([with_muscles(walks()[0], 5.0)], "y")
    assert not any(pair.key.is_emg for one in compare(made, louder) for pair in one.curves)
    assert session().trials[0].emg is None and made.trials[0].emg.rate_hz == 1500.0
