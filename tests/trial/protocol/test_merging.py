"""Two changes of one marker set: each marker by itself; one that both changed differently is named."""

from dataclasses import replace

from mbkf.model.protocol import load_protocol
from mbkf.model.protocol_file import protocol_text
from mbkf.trial.protocol.merging import merged_sets

BASE = load_protocol("reference36")


def moved(protocol, name, segment):
    markers = tuple(replace(one, segment=segment) if one.name == name else one for one in protocol.markers)
    return replace(protocol, markers=markers)


def left_out(protocol, name, reason="loose"):
    markers = tuple(one for one in protocol.markers if one.name != name)
    return replace(protocol, markers=markers, ignored={**protocol.ignored, name: reason})


def test_changes_of_different_markers_are_merged():
    mine, theirs = left_out(BASE, "RASI"), moved(BASE, "LKNE", "pelvis")
    both, differing = merged_sets(BASE, replace(mine, name="mine"), theirs)
    assert differing == () and both.name == "mine"
    assert protocol_text(both) == protocol_text(replace(left_out(theirs, "RASI"), name="mine"))


def test_a_marker_that_both_changed_is_named_and_one_change_is_kept():
    mine, theirs = left_out(moved(BASE, "LKNE", "pelvis"), "RASI"), left_out(BASE, "LKNE")
    for over, expected in ((False, theirs), (True, mine)):
        both, differing = merged_sets(BASE, mine, theirs, over)
        assert differing == ("LKNE",) and both.ignored["RASI"] == "loose"
        assert ("LKNE" in both.ignored) == ("LKNE" in expected.ignored)
        assert {one.name: one.segment for one in both.markers}.get("LKNE") == (None if not over else "pelvis")


def test_a_marker_taken_back_into_the_set_is_left_out_no_more():
    out = left_out(BASE, "RASI")
    both, differing = merged_sets(out, BASE, left_out(out, "LASI"))
    assert differing == () and set(both.ignored) == {"LASI"} and "RASI" in {one.name for one in both.markers}
