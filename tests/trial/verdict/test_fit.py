"""Fit of the markers of each part: distances over their noise, innovations, refused samples."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.model.human import reference_body
from mbkf.trial.results.innovations import settled
from mbkf.trial.verdict.fit import FitSums, MarkerFrames
from tests.recordings import walk


def moved(r, segment, by_m):
    """A result whose markers of a segment lie off the body."""
    own = {marker.name: marker.segment for marker in r.subject.markers}
    there = np.array([own[name] == segment for name in r.marker_names])
    return replace(r, measured_m=r.predicted_m + np.where(there[:, None], [by_m, 0.0, 0.0], 0.0)), there


def part_fits(r, block=None):
    """The fits of a result whose frames come in blocks."""
    squared = ((r.measured_m - r.predicted_m) ** 2).sum(axis=2)
    whole = (r.present, squared, r.tracked, r.rejected, r.marker_nis, settled(r))
    sums = FitSums(reference_body(r.subject), r.marker_names, r.subject.markers)
    for first in range(0, r.frames, block or r.frames):
        part = slice(first, first + (block or r.frames))
        sums.add(MarkerFrames(*(None if one is None else one[part] for one in whole)))
    return sums.fits()


def test_each_part_has_the_fit_of_its_own_markers():
    r, there = moved(walk(), "left_shank", 0.05)
    fits = {one.part: one for one in part_fits(r)}
    own = {marker.name: marker for marker in r.subject.markers}
    leg = fits["left_leg"]
    assert own[leg.worst].segment == "left_shank"
    assert leg.rms_mm == pytest.approx(50.0 * np.sqrt(there.sum() / leg.markers))
    assert fits["right_leg"].rms_mm == pytest.approx(0.0) and fits["pelvis"].per_noise == pytest.approx(0.0)
    noise = np.array([own[name].noise_m for name, here in zip(r.marker_names, there, strict=True) if here])
    expected = np.sqrt((0.05**2 / (3 * noise**2)).sum() / leg.markers)
    assert leg.per_noise == pytest.approx(expected)


def test_unseen_and_untracked_samples_do_not_count():
    r, there = moved(walk(), "left_shank", 0.05)
    gone = np.where(there[None, :, None], np.nan, r.measured_m)
    assert {one.part: one for one in part_fits(replace(r, measured_m=gone))}["left_leg"].rms_mm == 0.0
    assert part_fits(replace(r, tracked=np.zeros(r.frames, bool))) == ()


def test_innovations_count_once_the_filter_has_settled():
    r = walk()
    nis = np.full(r.present.shape, 2.0)
    nis[r.times_s < r.times_s[0] + 0.5] = 50.0
    fits = part_fits(replace(r, marker_nis=nis))
    assert {one.nis for one in fits} == {2.0}
    assert {one.nis for one in part_fits(replace(r, marker_nis=None))} == {None}


def test_refused_samples_are_a_share_of_the_part_s():
    r = walk()
    refused = np.zeros(r.present.shape, bool)
    refused[: r.frames // 2] = True
    assert part_fits(replace(r, rejected=refused))[0].refused == pytest.approx(0.5, abs=0.01)


def test_blocks_of_frames_give_what_the_whole_trial_gives():
    r, _ = moved(walk(), "left_shank", 0.03)
    r = replace(r, marker_nis=np.random.default_rng(0).uniform(0.0, 4.0, r.present.shape))
    for one, other in zip(part_fits(r, block=7), part_fits(r), strict=True):
        assert (one.part, one.markers, one.worst) == (other.part, other.markers, other.worst)
        numbers = [(a.rms_mm, a.per_noise, a.nis, a.refused) for a in (one, other)]
        assert numbers[0] == pytest.approx(numbers[1])
