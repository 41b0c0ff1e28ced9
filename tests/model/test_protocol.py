"""Every shipped protocol, the detection of a capture's protocol, and what is refused."""

from pathlib import Path

import numpy as np
import pytest

from mbkf.errors import FileFormatError, UnknownName
from mbkf.io.capture import read_capture
from mbkf.model.body_file import load_body, parse_body
from mbkf.model.protocol import KINDS, detect_protocol, load_protocol, protocol_names
from mbkf.model.sides import mirrored

LEGS = Path(__file__).resolve().parents[2] / "docs/examples/bodies/legs.toml"
SHIPPED = (
    "autolabel62",
    "biobuddy73",
    "blazepose",
    "body25",
    "cast",
    "cgm23",
    "cgm24",
    "cgm25",
    "coco17",
    "fukuchi2018",
    "gait2354",
    "halpe26",
    "hbm47",
    "helen_hayes",
    "ior_gait",
    "opencap43",
    "opencap_lab",
    "opensim_fullbody2009",
    "optitrack_biomech57",
    "optitrack_core50",
    "oxford_biomechzoo",
    "plug_in_gait",
    "qualisys_sports",
    "rajagopal_run",
    "rajagopal_walk",
    "reference36",
    "rehazenter52",
)

CAPTURES = {
    "gait2354_walk/subject01_static.trc": "gait2354",
    "gait2354_walk/subject01_walk1.trc": "gait2354",
    "rajagopal_walk_run/static_walk_1.trc": "rajagopal_walk",
    "rajagopal_walk_run/motion_capture_walk.trc": "rajagopal_walk",
    "rajagopal_walk_run/static_run.trc": "rajagopal_run",
    "rajagopal_walk_run/motion_capture_run.trc": "rajagopal_run",
    "synthetic_exact_truth/subject01_walk2_markers.trc": "rajagopal_run",
    "biomechzoo_walk_turn/HC032A_Static_HC032A01.c3d": "oxford_biomechzoo",
    "biomechzoo_walk_turn/HC044A_Straight_HC044A15.c3d": "oxford_biomechzoo",
    "gaitalytics_walk/overground_fullbody_4plates.c3d": "plug_in_gait",
    "opensim_gappy_walk/walking2.c3d": "opensim_fullbody2009",
    "autolabel_unlabelled_fullbody/PronetoRun01_labelled.c3d": "autolabel62",
    "stoop_lift_box/neu_t169_f250f350.c3d": "plug_in_gait",
    "cgm24_lowerlimb_walk/CGM24_Walking01.c3d": "cgm24",
    "rehazenter_walk/2014001_C1_01.c3d": "rehazenter52",
    "bmc_walk_run/lower_walk1.trc": "fukuchi2018",
    "bmc_walk_run/run.trc": "rajagopal_run",
    "biobuddy_functional/static.c3d": "biobuddy73",
    "biobuddy_functional/functional_right_knee.c3d": "biobuddy73",
    "pose2sim_keypoints_balance/static_raw.trc": "halpe26",
    "pose2sim_keypoints_balance/balancing_filt.trc": "halpe26",
}
NOT_FOLLOWED = ("Ground", "Mid", "v", "PELO")
"""Ends and beginnings of the points that no protocol takes over (projections, midpoints and virtual points)."""

NAME_LISTS = {
    "plug_in_gait": (
        "LFHD RFHD LBHD RBHD C7 T10 CLAV STRN LSHO LELB LWRA LWRB LFIN RSHO RELB RWRA RWRB RFIN LASI "
        "RASI SACR LTHI LKNE LTIB LANK LHEE LTOE RTHI RKNE RTIB RANK RHEE RTOE"
    ),
    "helen_hayes": (
        "Top.Head Front.Head Rear.Head R.Shoulder L.Shoulder R.Offset R.Elbow L.Elbow R.Wrist L.Wrist "
        "R.Asis L.Asis V.Sacral R.Thigh L.Thigh R.Knee L.Knee R.Shank L.Shank R.Ankle L.Ankle R.Heel "
        "L.Heel R.Toe L.Toe"
    ),
    "rajagopal_run": (
        "LPSI RPSI RTH2 RTH3 LTH1 LTH2 LTH3 RTB1 RTB2 LTB1 LTB2 RCAL RTOE RMT5 LCAL LTOE LMT5 LACR "
        "RACR CLAV C7 RUA1 RUA2 RUA3 RLEL LUA1 LUA2 LUA3 LLEL RASI LASI"
    ),
    "gait2354": (
        "R.ASIS L.ASIS V.Sacral R.Thigh.Upper R.Thigh.Front R.Thigh.Rear L.Thigh.Upper L.Thigh.Front "
        "R.Heel R.Midfoot.Sup R.Toe.Tip Sternum R.Acromium L.Acromium R.Wrist.Med Top.Head"
    ),
    "cgm23": (
        "LASI RASI LPSI RPSI LTHI LTHAP LTHAD LKNE LKNM LTIB LTIAP LTIAD LANK LMED LHEE LTOE "
        "RTHI RTHAP RTHAD RKNE RKNM RTIB RTIAP RTIAD RANK RMED RHEE RTOE"
    ),
    "cgm24": (
        "LASI RASI LPSI RPSI LTHI LTHAP LTHAD LKNE LKNM LTIB LTIAP LTIAD LANK LMED LHEE LTOE LFMH LSMH LVMH "
        "RTHI RTHAP RTHAD RKNE RKNM RTIB RTIAP RTIAD RANK RMED RHEE RTOE RFMH RSMH RVMH "
        "C7 T10 CLAV STRN LFHD LBHD RFHD RBHD LSHO LELB LWRA LWRB LFIN RSHO RELB RWRA RWRB RFIN"
    ),
    "cgm25": (
        "LASI RASI LPSI RPSI LTHI LTHAP LTHAD LKNE LTIB LTIAP LTIAD LANK LHEE LTOE LFMH LVMH "
        "RTHI RTHAP RTHAD RKNE RTIB RTIAP RTIAD RANK RHEE RTOE RFMH RVMH "
        "T2 T10 CLAV STRN GLAB LMAS RMAS LSHO LELB LWRA LWRB LFIN RSHO RELB RWRA RWRB RFIN"
    ),
    "ior_gait": (
        "RASIS LASIS RPSIS LPSIS RGT RLE RME RHF RTT RLM RMM RCA RFM RSM RVM LGT LLE LME LHF LTT LLM LMM LCA LFM "
        "LSM LVM C7 T2 MAI IJ PX L1 L3 L5 RA LA"
    ),
    "cast": (
        "RIAS LIAS RIPS LIPS RTH1 RTH2 RTH3 RTH4 RFLE RFME RSK1 RSK2 RSK3 RSK4 RFAL RTAM RFCC RFM1 RFM2 RFM5 "
        "LTH1 LTH2 LTH3 LTH4 LFLE LFME LSK1 LSK2 LSK3 LSK4 LFAL LTAM LFCC LFM1 LFM2 LFM5"
    ),
    "hbm47": (
        "LHEAD THEAD RHEAD FHEAD C7 T10 SACR NAVE XYPH STRN BBAC LSHO LDELT LLEE LMEE LFRM LMW LLW LFIN "
        "RSHO RDELT RLEE RMEE RFRM RMW RLW RFIN LASIS RASIS LPSIS RPSIS LGTRO FLTHI LLEK LATI LLM LHEE LTOE LMT5 "
        "RGTRO FRTHI RLEK RATI RLM RHEE RTOE RMT5"
    ),
    "optitrack_core50": (
        "HeadTop HeadFront HeadSide BackTop Chest BackLeft BackRight WaistLFront WaistRFront WaistLBack "
        "WaistRBack LShoulderTop LShoulderBack LUArmHigh LElbowOut LWristOut LWristIn LHandOut RShoulderTop "
        "RShoulderBack RUArmHigh RElbowOut RWristOut RWristIn RHandOut LThigh LKneeOut LShin LAnkleOut LToeIn "
        "LToeOut LToeTip LHeel RThigh RKneeOut RShin RAnkleOut RToeIn RToeOut RToeTip RHeel"
    ),
    "opencap_lab": (
        "r.ASIS L.ASIS r.PSIS L.PSIS C7 R_Shoulder L_Shoulder R_Sternum L_Sternum r_knee r_mknee r_ankle r_mankle "
        "r_toe r_5meta r_calc L_knee L_mknee L_ankle L_mankle L_toe L_5meta L_calc r_thigh1 r_thigh2 r_sh2 r_sh3 "
        "R_elbow_lat R_elbow_med R_wrist_radius R_wrist_ulna R_HJC L_HJC"
    ),
    "halpe26": (
        "RHip RKnee RAnkle RBigToe RSmallToe RHeel LHip LKnee LAnkle LBigToe LSmallToe LHeel Neck Head Nose RShoulder "
        "RElbow RWrist LShoulder LElbow LWrist"
    ),
    "body25": (
        "CHip RHip RKnee RAnkle RBigToe RSmallToe RHeel LHip LKnee LAnkle LBigToe LSmallToe LHeel Neck Nose RShoulder "
        "RElbow RWrist LShoulder LElbow LWrist"
    ),
    "coco17": (
        "nose left_eye right_eye left_ear right_ear left_shoulder right_shoulder left_elbow right_elbow left_wrist "
        "right_wrist left_hip right_hip left_knee right_knee left_ankle right_ankle"
    ),
    "blazepose": (
        "nose left_eye_inner left_eye left_eye_outer right_eye_inner right_eye right_eye_outer left_ear right_ear "
        "mouth_left mouth_right left_shoulder right_shoulder left_elbow right_elbow left_wrist right_wrist left_pinky "
        "right_pinky left_index right_index left_thumb right_thumb left_hip right_hip left_knee right_knee left_ankle "
        "right_ankle left_heel right_heel left_foot_index right_foot_index"
    ),
    "opencap43": (
        "r.ASIS_study L.ASIS_study r.PSIS_study L.PSIS_study r_knee_study r_mknee_study r_ankle_study r_mankle_study "
        "r_toe_study r_5meta_study r_calc_study L_knee_study L_mknee_study L_ankle_study L_mankle_study L_toe_study "
        "L_calc_study L_5meta_study r_shoulder_study L_shoulder_study C7_study r_thigh1_study r_thigh2_study "
        "r_thigh3_study L_thigh1_study L_thigh2_study L_thigh3_study r_sh1_study r_sh2_study r_sh3_study L_sh1_study "
        "L_sh2_study L_sh3_study RHJC_study LHJC_study r_lelbow_study r_melbow_study r_lwrist_study r_mwrist_study "
        "L_lelbow_study L_melbow_study L_lwrist_study L_mwrist_study"
    ),
}

TWO_STYLES = {
    "ior_gait": ("R_IAS R_FTC R_FLE L_FME R_FAX R_TTC CV7 SJN", "RIAS RGT RLE LFME RHF RTTC C7 IJ"),
    "cast": ("R_IAS R_TH1 R_SK4 L_FLE", "RIAS RTH1 RSK4 LFLE"),
    "qualisys_sports": (
        "HeadL WaistLFront LThighFrontLow LKneeIn",
        "Q_HeadL Q_WaistLFront Q_LThighFrontLow Q_LKneeIn",
    ),
    "opencap_lab": (
        "r.ASIS r_knee R_elbow_lat L_Shoulder",
        "r.ASIS_study r_knee_study r_lelbow_study L_shoulder_study",
    ),
}
"""Names of some sets, and how another laboratory writes the same ones."""


@pytest.fixture
def write(tmp_path):
    def to_file(*entries):
        path = tmp_path / "mine.toml"
        markers = "\n".join(f"[[marker]]\n{entry}" for entry in entries)
        path.write_text(f'name = "mine"\n{markers}\n', encoding="utf-8")
        return str(path)

    return to_file


def test_these_protocols_are_shipped():
    assert protocol_names() == SHIPPED


@pytest.mark.parametrize("name", SHIPPED)
def test_a_shipped_protocol_is_sound(name):
    protocol = load_protocol(name)
    segments = {segment.name for segment in protocol.body.segments}
    labels = [alias for marker in protocol.markers for alias in (marker.name, *marker.aliases)]
    assert protocol.name == name
    assert len(protocol.source) >= 20, "where it comes from"
    assert len(labels) == len(set(labels)), "a name or alias stands twice"
    for marker in protocol.markers:
        assert marker.segment in segments
        assert marker.kind in KINDS
        assert np.linalg.norm(marker.position_m) < 0.5
        assert 0.003 <= marker.noise_m <= 0.020
        assert 0.005 <= marker.placement_sd_m <= 0.100


@pytest.mark.parametrize("name", SHIPPED)
def test_markers_lie_on_the_side_their_name_says(name):
    for marker in load_protocol(name).markers:
        side = {"R": "right_", "L": "left_"}.get(marker.name[0].upper())
        if marker.segment.startswith(("right_", "left_")):
            assert marker.segment.startswith(side), marker.name


@pytest.mark.parametrize("name", SHIPPED)
def test_mirrored_markers_mirror(name):
    markers = {marker.name: marker for marker in load_protocol(name).markers}
    partners = {name: "L" + name[1:] for name in markers if name[0] in "Rr"}
    partners = {n: "L" + n[1:] for n in markers if n[0] in "Rr"}
    partners.update({n: "left" + n[5:] for n in markers if n.startswith("right")})
    pairs = [(markers[name], markers[other]) for name, other in partners.items() if other in markers]
    asymmetric = 0
    for right, left in pairs:
        assert left.segment == mirrored(right.segment)
        for attribute in ("kind", "noise_m", "placement_sd_m"):
            assert getattr(left, attribute) == getattr(right, attribute)
        asymmetric += not np.allclose(left.position_m, right.position_m * [1.0, -1.0, 1.0])
    assert pairs
    assert asymmetric == {"rajagopal_walk": 7}.get(name, 0), "only these clusters differ right and left"


@pytest.mark.parametrize("name", NAME_LISTS)
def test_detection_by_names(name):
    names = NAME_LISTS[name].split()
    assert detect_protocol([*names, "Angle1", "CentreOfMass"]).name == name
    assert len(load_protocol(name).match(names)) == len(names)


@pytest.mark.parametrize("name", SHIPPED)
def test_a_protocol_is_found_by_its_own_names(name):
    followed = [marker.name for marker in load_protocol(name).markers if marker.kind != "computed"]
    assert detect_protocol(followed).name == name


@pytest.mark.parametrize("name", TWO_STYLES)
def test_both_styles_of_writing_names_mean_the_same_markers(name):
    one, other = (names.split() for names in TWO_STYLES[name])
    protocol = load_protocol(name)
    assert list(protocol.match(one).values()) == list(protocol.match(other).values())
    assert len(protocol.match(one)) == len(one)


def test_plug_in_gait_with_medial_markers_is_not_taken_for_a_later_model():
    legs = ["ASI", "PSI", "THI", "KNE", "KNM", "TIB", "ANK", "MED", "HEE", "TOE"]
    assert detect_protocol([side + name for side in "LR" for name in legs]).name == "plug_in_gait"


@pytest.mark.parametrize("name", ["rehazenter52", "optitrack_biomech57", "plug_in_gait", "cgm24", "cast"])
def test_of_sets_with_the_same_legs_the_complete_one_is_found(name):
    """ior_gait, cast, rehazenter52 and biomech57 share names, as plug_in_gait and the CGMs: what is lacking tells."""
    legs = ("pelvis", "thigh", "shank", "foot", "toes")
    worn = [m.name for m in load_protocol(name).markers if m.segment.endswith(legs) and not m.static_only]
    assert detect_protocol(worn).name == name


@pytest.mark.parametrize("file", CAPTURES)
def test_detection_on_real_captures(real_data, file):
    names = read_capture(real_data / file).markers.names
    protocol = detect_protocol(names)
    assert protocol.name == CAPTURES[file]
    left = [name for name in names if name not in protocol.match(names)]
    assert [n for n in left if not n.endswith(NOT_FOLLOWED) and not n.startswith(NOT_FOLLOWED)] == []


def test_unknown_marker_sets_are_refused():
    with pytest.raises(UnknownName, match="give --protocol"):
        detect_protocol(["a", "b", "RASI"])
    with pytest.raises(UnknownName, match=r"no markers"):
        detect_protocol([])


def test_each_marker_is_matched_once_by_its_own_name_before_an_alias():
    protocol = load_protocol("helen_hayes")
    found = protocol.match(["R.Asis", "R.ASIS", "V.Sacrum", "unknown"])
    matched = {name: marker.name for name, marker in found.items()}
    assert matched == {"R.ASIS": "R.ASIS", "V.Sacrum": "V.Sacral"}


def test_own_protocol_from_a_file(write):
    path = write(
        'name = "RK"\nlandmark = "right_knee_lateral"\nmirror = "LK"',
        'name = "X"\nsegment = "pelvis"\nposition_m = [0, 0.1, -0.2]\nnoise_mm = 7\naliases = ["Y"]',
    )
    right, left, technical = load_protocol(path).markers
    landmark = load_body().landmark("right_knee_lateral")
    np.testing.assert_array_equal(right.position_m, landmark.position_m)
    assert (left.name, left.segment, right.kind) == ("LK", "left_thigh", "anatomical")
    np.testing.assert_array_equal(left.position_m, right.position_m * [1.0, -1.0, 1.0])
    assert (technical.kind, technical.noise_m, technical.placement_sd_m) == ("technical", 0.007, 0.060)
    assert technical.aliases == ("Y",)


@pytest.mark.parametrize(
    ("entries", "error", "complaint"),
    [
        (['name = "X"\nsegment = "pelvic"\nposition_m = [0, 0, 0]'], UnknownName, "did you mean pelvis"),
        (['name = "X"\nlandmark = "right_knee_laterl"'], UnknownName, "did you mean right_knee_lateral"),
        (['name = "X"\nlandmark = "c7"\nnoise = 5'], UnknownName, "'noise'; did you mean noise_mm"),
        (['name = "X"\nlandmark = "c7"\nkind = "bone"'], UnknownName, "unknown marker kind 'bone'"),
        (
            ['name = "X"\nlandmark = "c7"', 'name = "X"\nlandmark = "t6"'],
            FileFormatError,
            "'X' is defined twice",
        ),
        (['name = "X"\nlandmark = "right_heel"\nmirror = "X"'], FileFormatError, "'X' is defined twice"),
        (['name = "X"\nsegment = "pelvis"'], FileFormatError, "position_m"),
        (['name = "X"\nlandmark = "c7"\nstatic_only = "yes"'], FileFormatError, "true or false"),
        (['name = "X'], FileFormatError, "not a valid protocol"),
    ],
)
def test_faulty_protocols_are_refused(write, entries, error, complaint):
    with pytest.raises(error, match=complaint):
        load_protocol(write(*entries))


def test_unknown_and_missing_protocols():
    with pytest.raises(UnknownName, match="did you mean plug_in_gait"):
        load_protocol("plugin_gait")
    with pytest.raises(FileFormatError, match="cannot be read"):
        load_protocol("no/such/file.toml")


def test_markers_for_the_static_trial_only_say_so_on_both_sides():
    markers = {marker.name: marker for marker in load_protocol("oxford_biomechzoo").markers}
    off = {name for name, marker in markers.items() if marker.static_only}
    assert off == {f"{side}{part}" for side in "RL" for part in ("MMA", "PCA", "D1M", "TPF")}
    medial = {marker.name for marker in load_protocol("plug_in_gait").markers if marker.static_only}
    assert medial == {"RKNM", "LKNM", "RMED", "LMED"}


def test_a_protocol_is_placed_on_another_body():
    """Markers whose place the body lacks are left out, the others sit on its own landmarks."""
    legs = load_body(LEGS)
    whole, placed = load_protocol("reference36"), load_protocol("reference36", legs)
    segments = {segment.name for segment in legs.segments}
    assert placed.body is legs
    assert [m.name for m in placed.markers] == [m.name for m in whole.markers if m.segment in segments]
    broad = parse_body(legs.text.replace("[0.07, -0.119, -0.205]", "[0.07, -0.129, -0.205]"), "broad")
    markers = {m.name: m for m in load_protocol("reference36", broad).markers}
    np.testing.assert_array_equal(markers["LASI"].position_m, [0.07, 0.129, -0.205])
    assert detect_protocol([m.name for m in placed.markers], legs).name == "reference36"


def test_typing_errors_are_told_on_another_body_too(write):
    with pytest.raises(UnknownName, match="did you mean right_knee_lateral"):
        load_protocol(write('name = "X"\nlandmark = "right_knee_laterl"'), load_body(LEGS))
    assert load_protocol(write('name = "X"\nlandmark = "c7"'), load_body(LEGS)).markers == ()


def test_a_protocol_names_its_body_by_a_file_beside_it(tmp_path):
    (tmp_path / "legs.toml").write_text(LEGS.read_text(encoding="utf-8"), encoding="utf-8")
    path = tmp_path / "mine.toml"
    path.write_text(
        'name = "mine"\nbody = "legs.toml"\n[[marker]]\nname = "X"\nlandmark = "right_asis"\n', "utf-8"
    )
    assert load_protocol(path).body.name == "legs"


def test_raw_keypoints_beside_augmented_ones_are_told_and_left(real_data):
    names = read_capture(real_data / "pose2sim_keypoints_balance/static_filt_LSTM.trc").markers.names
    protocol = detect_protocol(names)
    assert protocol.name == "opencap43"
    matched = protocol.match(names)
    assert len(matched) == 45, "43 points and the two on the head"
    assert set(names) - set(matched) == set(names) & set(protocol.ignored)


@pytest.mark.parametrize("name", ["halpe26", "body25", "coco17", "blazepose", "opencap43"])
def test_keypoints_have_the_noise_of_their_kind(name):
    protocol = load_protocol(name)
    assert protocol.source
    for marker in protocol.markers:
        assert marker.kind == "keypoint"
        assert (marker.noise_m, marker.correlated_m, marker.correlation_s) == (0.020, 0.010, 0.3)


def test_noise_that_stays_from_a_file(write):
    place = 'segment = "pelvis"\nposition_m = [0, 0.1, -0.2]'
    own, halved, still = load_protocol(
        write(
            f'name = "A"\n{place}\nkind = "keypoint"\nnoise_mm = 30\ncorrelated_mm = 25\ncorrelation_s = 0.5',
            f'name = "B"\n{place}\nkind = "keypoint"\nnoise_mm = 8',
            f'name = "C"\n{place}',
        )
    ).markers
    assert (own.noise_m, own.correlated_m, own.correlation_s) == (0.030, 0.025, 0.5)
    assert (halved.noise_m, halved.correlated_m, halved.correlation_s) == (0.008, 0.004, 0.3)
    assert (still.correlated_m, still.correlation_s) == (0.0, 0.0)


def test_a_part_of_the_noise_is_no_larger_than_it(write):
    place = 'name = "A"\nsegment = "pelvis"\nposition_m = [0, 0.1, -0.2]'
    with pytest.raises(FileFormatError, match="correlated_mm"):
        load_protocol(write(f"{place}\nnoise_mm = 5\ncorrelated_mm = 6"))
    with pytest.raises(FileFormatError, match="correlation_s"):
        load_protocol(write(f"{place}\nnoise_mm = 5\ncorrelated_mm = 4\ncorrelation_s = -1"))
