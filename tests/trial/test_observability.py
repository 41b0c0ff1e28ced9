"""What the shipped protocols determine, and what goes with lost markers."""

import pytest

from mbkf.errors import NotObservable, UnknownName
from mbkf.model.protocol import load_protocol
from mbkf.trial.observability import check_protocol

HANDS, TOES = {"right_hand", "left_hand"}, {"right_toes", "left_toes"}
ARMS = {"right_upper_arm", "right_forearm", "left_upper_arm", "left_forearm"}
HEAD = {"neck", "head"}
BLIND = {
    "reference36": set(),
    "plug_in_gait": {"right_hand", "left_hand", "right_toes", "left_toes"},
    "oxford_biomechzoo": {"right_hand", "left_hand"},
    "gait2354": {"right_hand", "left_hand"},
    "rajagopal_walk": {"neck", "head", "right_hand", "left_hand"},
    "rajagopal_run": {"neck", "head", "right_hand", "left_hand"},
    "autolabel62": {"right_hand", "left_hand", "right_toes", "left_toes"},
    "biobuddy73": set(),
    "optitrack_core50": set(),
    "cgm23": HANDS | TOES,
    "cgm24": HANDS | TOES,
    "cgm25": HANDS | TOES,
    "hbm47": HANDS | TOES,
    "qualisys_sports": HANDS | TOES,
    "optitrack_biomech57": HANDS,
    "opencap_lab": HANDS | HEAD,
    "rehazenter52": TOES | HEAD,
    "ior_gait": HANDS | HEAD | ARMS,
    "cast": HANDS | HEAD | ARMS | TOES | {"torso"},
    "fukuchi2018": HANDS | HEAD | ARMS | TOES | {"torso"},
    "helen_hayes": {"right_forearm", "left_forearm", "right_hand", "left_hand", "right_toes", "left_toes"},
    "opensim_fullbody2009": {
        *("right_upper_arm", "right_forearm", "right_hand", "right_toes"),
        *("left_upper_arm", "left_forearm", "left_hand", "left_toes"),
    },
}


def segments_of(dofs):
    return {dof.rpartition("_")[0] for dof in dofs}


def test_the_reference_protocol_determines_all_52_dofs_and_their_velocities():
    check = check_protocol(load_protocol("reference36"))
    assert len(check.markers) == 36
    assert (check.after.ranks == 52).all()
    assert (check.after.state_ranks == 104).all()
    assert check.after.complete
    assert check.lost_dofs == ()


@pytest.mark.parametrize("name", BLIND)
def test_each_protocol_lacks_what_it_has_no_markers_for(name):
    found = check_protocol(load_protocol(name)).after
    assert segments_of(found.unobserved + found.sometimes_unobserved) == BLIND[name]


def test_computed_points_do_not_count():
    check = check_protocol(load_protocol("rajagopal_run"))
    assert "RHJC" not in check.markers
    assert "RACR" in check.markers


@pytest.mark.parametrize(
    ("lost", "segments"),
    [
        (["RHAL"], {"right_toes"}),
        (["RHA2", "RHA5"], {"right_hand"}),
        (["RFHD", "BHD"], {"neck", "head"}),
        (["RTHI"], set()),
    ],
)
def test_lost_markers_take_their_segments_with_them(lost, segments):
    check = check_protocol(load_protocol("reference36"), lost)
    assert check.before.complete
    assert segments_of(check.lost_dofs) >= segments
    if not segments:
        assert check.lost_dofs == ()


def test_markers_may_be_lost_by_their_alias_and_only_once():
    check = check_protocol(load_protocol("helen_hayes"), ["R.Asis", "R.ASIS"])
    assert check.lost == ("R.ASIS",)
    assert "R.ASIS" not in check.markers


def test_unknown_marker_names_the_close_ones():
    with pytest.raises(UnknownName, match="reference36: unknown marker 'RHEEL'; did you mean RHEE"):
        check_protocol(load_protocol("reference36"), ["RHEEL"])
    with pytest.raises(UnknownName):
        check_protocol(load_protocol("rajagopal_run"), ["RHJC"])


def test_losing_everything_is_an_error():
    protocol = load_protocol("reference36")
    with pytest.raises(NotObservable, match="no marker left"):
        check_protocol(protocol, [marker.name for marker in protocol.markers])
