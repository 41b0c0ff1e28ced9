"""Sums over the frames of a trial: blocks of a live run give the evidence of the whole trial."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.io.unexplained import UnexplainedLoad
from mbkf.trial.results.innovations import settled
from mbkf.trial.verdict.evidence import Found, evidence_from, evidence_of
from mbkf.trial.verdict.fit import MarkerFrames
from mbkf.trial.verdict.sums import Followed, Frames, TrialSums, acting
from tests.recordings import broken_walk, walk


def in_blocks(r, size):
    sums, acts = TrialSums(Followed.of(r)), acting(r)
    squared = ((r.measured_m - r.predicted_m) ** 2).sum(axis=2)
    for first in range(0, r.frames, size):
        part = slice(first, first + size)
        nis = None if r.marker_nis is None else r.marker_nis[part]
        markers = MarkerFrames(
            r.present[part], squared[part], r.tracked[part], r.rejected[part], nis, settled(r)[part]
        )
        sums.add(Frames(r.q[part], markers, r.angles_sd[part], (r.valid | acts)[part], acts[part]))
    return sums


@pytest.mark.parametrize("trial", [walk, broken_walk])
def test_blocks_of_frames_give_the_evidence_of_the_whole_trial(trial):
    r = trial()
    pull = UnexplainedLoad(float(r.times_s[3]), float(r.times_s[9]), (0.0, 0.0, 200.0), 8.0, 0.3)
    r = replace(r, unexplained=(pull,))
    whole = evidence_of(r)
    found = evidence_from(
        in_blocks(r, 7),
        Found(r.limb_doubts, r.unexplained, r.contacts, r.checks, r.markers_explained, r.smoothed),
    )
    assert whole.tracked == found.tracked and whole.unexplained_share == found.unexplained_share > 0.0
    assert whole.spread_deg == pytest.approx(found.spread_deg) and whole.spread_deg
    assert whole.beyond == found.beyond
    assert [one.rms_mm for one in whole.fits] == pytest.approx([one.rms_mm for one in found.fits])
    same = ("unshown", "unshown_segments", "contacts", "doubts", "stood", "part_of")
    for name in same:
        assert getattr(whole, name) == getattr(found, name), name


def test_nothing_is_known_before_the_first_frame():
    sums = TrialSums(Followed.of(walk()))
    assert sums.fits() == sums.beyond() == () and sums.mean_sd() == {} and sums.seen == frozenset()


def test_spreads_count_where_the_body_is_followed():
    r = walk()
    sd, tracked = np.full(r.angles_sd.shape, 0.1), np.ones(r.frames, bool)
    sd[:5], tracked[:5], sd[7, 0] = 9.0, False, np.nan
    means = TrialSums.of(replace(r, angles_sd=sd, tracked=tracked)).mean_sd()
    assert set(means) == set(r.coordinate_names) and max(means.values()) == pytest.approx(0.1)
