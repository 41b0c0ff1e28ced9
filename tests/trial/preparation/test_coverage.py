"""Which markers of a capture are used: counts and reasons of made sets, and where a protocol is refused."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.io.records import MarkerTrajectories
from mbkf.io.subject import Subject, SubjectMarker
from mbkf.model.body_file import load_body
from mbkf.model.protocol import load_protocol
from mbkf.trial.preparation.coverage import (
    COMPUTED,
    NO_SEGMENT,
    TWICE,
    UNKNOWN,
    USE_KEY,
    MarkerUse,
    listed,
    use_by_protocol,
    use_by_subject,
)
from tests.trial.test_own_body import FILE

PLUG_IN_GAIT = load_protocol("plug_in_gait")


def markers(names, unseen=()):
    positions = np.zeros((3, len(names), 3))
    positions[:, [name in unseen for name in names]] = np.nan
    return MarkerTrajectories(tuple(names), positions, 100.0)


def names_of(protocol, words=("",)):
    return [
        m.name for m in protocol.markers if m.kind != "computed" and any(word in m.segment for word in words)
    ]


def strangers(count):
    return [f"X{i}" for i in range(count)]


def test_points_without_name_and_empty_columns_do_not_count():
    names = [*names_of(PLUG_IN_GAIT), "X", "Y", "*40", "*41"]
    use = use_by_protocol([markers(names, unseen=("Y", "LASI"))], PLUG_IN_GAIT)
    assert use.ignored == {"X": UNKNOWN}
    assert "LASI" not in use.used
    assert use.markers == len(names) - 4
    assert use.share == pytest.approx(1.0 - 1.0 / use.markers)


def test_a_name_in_several_captures_counts_once():
    static, trial = markers([*names_of(PLUG_IN_GAIT), "X"]), markers(["LASI", "X", "Y"])
    use = use_by_protocol([static, trial], PLUG_IN_GAIT)
    assert (use.markers, use.unknown) == (len(names_of(PLUG_IN_GAIT)) + 2, ("X", "Y"))


@pytest.mark.parametrize(
    ("known", "unknown", "accepted"),
    [(6, 4, True), (59, 41, False), (7, 44, False), (0, 1, False), (0, 0, True)],
)
def test_the_bound_is_sixty_percent(known, unknown, accepted):
    use = MarkerUse("p", tuple(f"K{i}" for i in range(known)), dict.fromkeys(strangers(unknown), UNKNOWN))
    assert use.accepted == accepted
    assert bool(use.warning) != accepted
    if not accepted:
        assert use.warning.startswith(f"protocol p knows {known} of {known + unknown} ")


def test_points_that_a_marker_set_leaves_out_keep_their_reason():
    box = replace(PLUG_IN_GAIT, ignored={"BOX1": "no part of the body", "GONE": "no part of the body"})
    use = use_by_protocol([markers([*names_of(PLUG_IN_GAIT), "BOX1", "X"])], box)
    assert use.ignored == {"BOX1": "no part of the body", "X": UNKNOWN}
    assert use.unknown == ("X",)


def test_markers_of_segments_that_the_body_lacks_are_explained():
    protocol = load_protocol("reference36", load_body(FILE))
    use = use_by_protocol([markers(names_of(load_protocol("reference36")))], protocol)
    assert use.share == 1.0
    assert set(use.ignored.values()) == {NO_SEGMENT}
    assert len(use.used) + len(use.ignored) == 36


def test_a_second_name_of_a_marker_is_told():
    protocol = load_protocol("helen_hayes")
    marker = next(m for m in protocol.markers if m.aliases)
    use = use_by_protocol([markers([marker.aliases[0], marker.name])], protocol)
    assert (use.used, use.ignored) == ((marker.name,), {marker.aliases[0]: TWICE})


def test_a_trial_of_a_person_tells_computed_points_and_strangers():
    protocol = load_protocol("rajagopal_run")
    computed = next(m.name for m in protocol.markers if m.kind == "computed")
    own = names_of(protocol)
    person = Subject(
        "human18",
        70.0,
        {},
        tuple(SubjectMarker(n, "pelvis", np.zeros(3), 0.005, 0.005) for n in own),
        protocol.name,
    )
    use = use_by_subject(markers([*own, computed, "X", "*9"]), person)
    assert use.used == tuple(own)
    assert use.ignored == {computed: COMPUTED, "X": UNKNOWN}
    assert use.share == pytest.approx(1.0 - 1.0 / (len(own) + 2))
    foreign = use_by_subject(markers([*own, computed]), replace(person, protocol="my own"))
    assert foreign.ignored == {computed: UNKNOWN}
    report = {"markers": {computed: {"kind": "computed"}, own[0]: {"kind": "technical"}}}
    scaled = replace(person, protocol="my own", report=report)
    assert use_by_subject(markers([*own, computed]), scaled).ignored == {computed: COMPUTED}
    left_out = {USE_KEY: {"ignored": {"BOX": "no part of the body", "X": UNKNOWN}}}
    inferred = replace(person, protocol="inferred", report=left_out)
    assert use_by_subject(markers([*own, "BOX", "Y"]), inferred).ignored == {
        "BOX": "no part of the body",
        "Y": UNKNOWN,
    }


def test_markers_that_are_not_used_after_all_stay_explained():
    use = MarkerUse("p", ("A", "B"), {"X": UNKNOWN}).without({"A": "seen in 2 % of the frames", "C": "?"})
    assert (use.used, dict(use.ignored)) == (("B",), {"X": UNKNOWN, "A": "seen in 2 % of the frames"})
    assert use.share == pytest.approx(2 / 3)


def test_long_lists_are_cut_with_their_length():
    assert listed(["A", "B"]) == "A, B"
    assert listed(strangers(9)).endswith("X7 … (9 in all)")
