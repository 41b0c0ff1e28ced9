"""Pieces of a trial with their margins."""

from mbkf.trial.long.pieces import PieceSettings, pieces_of


def test_pieces_follow_each_other_and_margins_end_with_the_trial():
    found = list(pieces_of(250, 100.0, PieceSettings(frames=100, margin_s=0.3)))
    assert [(one.first, one.after) for one in found] == [(0, 100), (100, 200), (200, 250)]
    assert [(one.begin, one.end) for one in found] == [(0, 130), (70, 230), (170, 250)]
    frames = list(range(250))
    for one in found:
        assert frames[one.whole][one.inner] == frames[one.own]
