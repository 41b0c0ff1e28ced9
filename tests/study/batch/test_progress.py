"""The share of a trial's time grows through its stages, and is 0 outside of them."""

import pytest

from mbkf.study.batch.progress import FILTERING, MARKERS, READING, SHARES, WRITING, Progress


def test_the_share_grows_from_stage_to_stage():
    stages = [
        Progress(),
        Progress(READING, 0, 1),
        Progress(MARKERS, 1, 100),
        Progress(MARKERS, 100, 100),
        Progress(FILTERING, 50, 100),
        Progress(FILTERING, 100, 100),
        Progress(WRITING, 1, 1),
    ]
    shares = [one.share for one in stages]
    assert shares == sorted(shares) and shares[0] == shares[1] == 0.0
    assert shares[-1] == pytest.approx(1.0) == sum(SHARES.values())


@pytest.mark.parametrize(
    ("progress", "share"),
    [
        (Progress("Scaling", 3, 4), 0.0),
        (Progress(FILTERING, 5, 0), SHARES[READING] + SHARES[MARKERS]),
        (Progress(READING, 9, 3), SHARES[READING]),
    ],
)
def test_odd_counts_stay_within_their_stage(progress, share):
    assert progress.share == pytest.approx(share)
