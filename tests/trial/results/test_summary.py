"""The summary's numbers against their definitions on made-up reconstructions."""

import json
from types import SimpleNamespace

import numpy as np
import pytest

from mbkf.conventions import GRAVITY_M_S2
from mbkf.errors import InvalidInput
from mbkf.io.subject import Subject
from mbkf.io.unexplained import UnexplainedLoad
from mbkf.model.clinical import ClinicalAngles, dof_names
from mbkf.model.human import HumanModel
from mbkf.trial.results.summary import compare_with_truth, summarise
from tests.io.reconstructions import made_up, with_trunk

KEYS = {
    "verdict",
    "trial", "protocol", "filter", "smoothed", "version", "direction", "progression", "mass_kg",
    "frames", "rate_hz", "duration_s", "markers_ignored", "markers_explained", "names_exchanged", "checks",
    "markers_used", "missing_fraction", "marker_rms_mm", "marker_max_mm", "marker_rms_mm_by_name",
    "residual_force_rms_n", "residual_moment_rms_nm", "residual_force_share",
    "residual_lever_m", "valid_frames", "measured_frames", "contacts", "unexplained", "limb_doubts",
    "plate_force_change_rms_n",
    "plate_moment_change_rms_nm", "torque_peak_nm_per_kg", "torque_sd_nm", "torque_sd_offset_nm",
    "torque_sd_varying_nm", "trunk_moments", "nis_per_dof", "nis", "marker_noise_mm_by_name", "later_frames",
    "step_seconds_median", "step_seconds_p99", "realtime_factor", "hidden_marker_rms_mm",
    "hidden_marker_max_mm", "truth", "axes", "warnings", "settings",
}  # fmt: skip


def test_the_keys_are_those_of_the_contract_and_plain_data():
    summary = summarise(made_up())
    assert set(summary) == KEYS
    json.dumps(summary, allow_nan=False)
    assert summary["truth"] is None
    assert summary["hidden_marker_rms_mm"] is None
    assert summary["plate_force_change_rms_n"] is None
    assert summary["duration_s"] == pytest.approx(0.12)
    assert summary["realtime_factor"] == pytest.approx(10.0)
    assert summary["step_seconds_median"] == pytest.approx(1e-3)


def test_the_frame_of_the_pelvis_is_told_with_its_mean_heading_and_how_far_it_turns():
    """The mean of angles about ±180° is near ±180°, not near 0."""
    assert summarise(made_up())["progression"] == {
        "kind": "laboratory",
        "heading_deg": 0.0,
        "turned_deg": 0.0,
    }
    heading = np.deg2rad(np.linspace(170.0, 192.0, 12))
    found = summarise(made_up(direction="progression", heading_rad=heading))
    assert found["direction"] == "progression"
    assert found["progression"]["kind"] == "turning path"
    assert found["progression"]["heading_deg"] == pytest.approx(-179.0)
    assert found["progression"]["turned_deg"] == pytest.approx(22.0)


def test_an_empty_or_untracked_reconstruction_has_no_numbers_but_no_error():
    empty = summarise(made_up(0))
    assert empty["marker_rms_mm"] is empty["nis_per_dof"] is empty["realtime_factor"] is None
    lost = summarise(
        made_up(tracked=np.zeros(12, bool), measured=np.zeros(12, bool), valid=np.zeros(12, bool))
    )
    assert (
        lost["marker_rms_mm"]
        is lost["residual_force_rms_n"]
        is lost["torque_peak_nm_per_kg"]["hip_r"]
        is None
    )
    assert lost["valid_frames"] == lost["measured_frames"] == 0
    assert lost["contacts"] == empty["contacts"] == lost["unexplained"] == []


def test_marker_errors_leave_out_hidden_missing_and_untracked_samples():
    predicted = np.zeros((12, 2, 3))
    measured = np.zeros((12, 2, 3))
    measured[:, 0, 0], measured[:, 1, 2] = 0.003, 0.004
    hidden, tracked, rejected = np.zeros((12, 2), bool), np.ones(12, bool), np.zeros((12, 2), bool)
    measured[0, 0] = np.nan
    measured[1, 0], hidden[1, 0] = [0.5, 0.0, 0.0], True
    measured[2, 0], tracked[2] = [0.7, 0.0, 0.0], False
    measured[3, 1], rejected[3, 1] = [0.0, 0.009, 0.0], True
    summary = summarise(
        made_up(predicted_m=predicted, measured_m=measured, hidden=hidden, tracked=tracked, rejected=rejected)
    )
    squares = [9.0] * 9 + [16.0] * 10 + [81.0]
    assert summary["marker_rms_mm"] == pytest.approx(np.sqrt(np.mean(squares)))
    assert summary["marker_max_mm"] == pytest.approx(9.0)
    assert summary["marker_rms_mm_by_name"]["A"] == pytest.approx(3.0)
    assert summary["hidden_marker_rms_mm"] == summary["hidden_marker_max_mm"] == pytest.approx(500.0)
    assert summary["missing_fraction"] == pytest.approx(2 / 24)


def test_residual_counts_measured_frames_only_as_a_norm():
    force, measured = np.zeros((12, 3)), np.ones(12, bool)
    force[:6], force[6:] = [3.0, 4.0, 0.0], [0.0, 0.0, 5.0]
    force[2], measured[2] = 1000.0, False
    summary = summarise(made_up(residual_force_n=force, measured=measured))
    assert summary["residual_force_rms_n"] == pytest.approx(5.0)
    weight_n = GRAVITY_M_S2 * summary["mass_kg"]
    assert summary["residual_force_share"] == pytest.approx(5.0 / weight_n)
    assert (summary["measured_frames"], summary["valid_frames"]) == (11, 12)


def test_contacts_are_told_as_plain_data():
    support = np.zeros((12, 1, 6))
    support[6:, 0, 2], r = 250.0, made_up()
    source = np.ones((12, 2), int)
    source[:, 1] = 2
    summary = summarise(
        made_up(
            foot_source=source, foot_wrench_sd=np.full((12, 2, 6), 3.0), support_names=("pelvis",),
            support_wrench=support, support_wrench_sd=np.full((12, 1, 6), np.nan),
            support_point_m=support[..., :3],
        )
    )  # fmt: skip
    right, left, pelvis = summary["contacts"]
    assert (right["part"], left["part"], pelvis["part"]) == ("right_foot", "left_foot", "pelvis")
    assert (right["how"], left["how"], pelvis["how"]) == ("measured", "shared", "estimated")
    assert right["peak_n"] == pytest.approx(np.linalg.norm(r.foot_wrench[:, 0, :3], axis=1).max())
    assert right["sd_n"] == pytest.approx(3.0) and pelvis["sd_n"] is None
    assert (pelvis["from_s"], pelvis["to_s"]) == (r.times_s[6], r.times_s[11])
    assert pelvis["peak_n"] == 250.0


def test_unexplained_loads_are_plain_data():
    load = UnexplainedLoad(1.2, 9.8, (30.0, 0.0, 590.0), 8.0, 0.82, "", "a seat")
    (found,) = summarise(made_up(unexplained=(load,)))["unexplained"]
    assert found["force_n"] == pytest.approx(590.76, abs=0.01)
    assert found["vector_n"] == [30.0, 0.0, 590.0]
    assert {key: found[key] for key in found if key not in ("force_n", "vector_n")} == {
        "from_s": 1.2, "to_s": 9.8, "sd_n": 8.0, "direction": "upward", "share_of_weight": 0.82, "cause": "",
        "hint": "a seat",
    }  # fmt: skip


def test_plate_changes_are_per_component_and_torques_per_joint():
    change = np.full((12, 2, 6), np.nan)
    change[:, 0] = [2.0, 2.0, 2.0, 3.0, -3.0, 3.0]
    moments, sd = np.zeros((12, 3)), np.ones((12, 3))
    moments[4, 2], sd[:6, 2] = -141.0, 3.0
    summary = summarise(made_up(plate_change=change, moments=moments, moments_sd=sd))
    assert summary["plate_force_change_rms_n"] == pytest.approx(2.0)
    assert summary["plate_moment_change_rms_nm"] == pytest.approx(3.0)
    assert summary["torque_peak_nm_per_kg"] == {"hip_r": pytest.approx(2.0)}
    assert summary["torque_sd_nm"] == {"hip_r": pytest.approx(2.0)}
    assert summary["torque_sd_offset_nm"] == {"hip_r": 0.0}
    assert summary["torque_sd_varying_nm"] == {"hip_r": pytest.approx(2.0)}


@pytest.fixture(scope="module")
def body():
    model = HumanModel.scaled(mass_kg=70.0)
    return model, ClinicalAngles(model)


def on_body(body, q, v, covariance=None, **changes):
    model, clinical = body
    T, A, zeros = len(q), len(clinical.names), np.zeros((len(q), model.nv))
    same = {name: zeros for name in ("a", "tau", "sd_q", "sd_v", "sd_tau")}
    coordinates = {
        name: np.zeros((T, A))
        for name in ("angles", "angle_rates", "moments", "angles_sd", "angle_rates_sd", "moments_sd")
    }
    return made_up(
        T, subject=Subject("human18", 70.0, {}, (), "reference36"), dof_names=dof_names(model), q=q, v=v,
        coordinate_names=clinical.names, singular=np.zeros((T, A), bool), covariance=covariance,
        foot_wrench=np.zeros((T, 2, 6)), **{**same, **coordinates, **changes},
    )  # fmt: skip


def truth_of(r, model, **changes):
    zero = np.zeros((r.frames, model.nv))
    values = {"times_s": r.times_s, "q": r.q, "v": zero, "a": zero, "tau": zero,
              "foot_wrench": np.zeros((r.frames, 2, 6))}  # fmt: skip
    return SimpleNamespace(**{**values, **changes})


def test_errors_against_the_truth_are_those_put_in(body):
    model, _ = body
    rng = np.random.default_rng(0)
    T, n = 400, model.nv
    L = 0.02 * (np.eye(2 * n) + 0.1 * rng.normal(size=(2 * n, 2 * n)))
    error = rng.normal(size=(T, 2 * n)) @ L.T
    q = np.array([model.integrate(model.neutral(), v) for v in rng.uniform(-0.5, 0.5, (T, n))])
    true_q = np.array([model.integrate(a, e[:n]) for a, e in zip(q, error, strict=True)])
    tracked = np.ones(T, bool)
    tracked[7] = False
    q[7] = np.nan
    r = on_body(body, q, np.zeros((T, n)), np.tile(L @ L.T, (T, 1, 1)), tracked=tracked)
    force = np.zeros((T, 2, 6))
    force[..., :3], force[..., 3:] = 2.0, 1e3
    truth = truth_of(r, model, q=true_q, v=error[:, n:], tau=np.full((T, n), 3.0), foot_wrench=force)
    summary = summarise(r, truth)["truth"]
    kept = error[tracked]
    assert summary["angle_rms_deg"] == pytest.approx(np.rad2deg(np.sqrt(np.mean(kept[:, 6:n] ** 2))))
    assert summary["velocity_rms_rad_s"] == pytest.approx(np.sqrt(np.mean(kept[:, n + 6 :] ** 2)))
    assert summary["torque_rms_nm"] == pytest.approx(3.0)
    assert summary["reaction_rms_n"] == pytest.approx(2.0)
    assert summary["nees_per_dof"] == pytest.approx(1.0, abs=4 * np.sqrt(2 / (T * 2 * n)))


def test_a_dof_without_uncertainty_does_not_break_the_consistency(body):
    model, _ = body
    q = np.tile(model.neutral(), (3, 1))
    P = np.zeros((3, 104, 104))
    P[:, :52, :52] = np.eye(52)
    true_q = np.array([model.integrate(a, np.full(52, 0.01)) for a in q])
    r = on_body(body, q, np.zeros((3, 52)), P)
    assert compare_with_truth(r, truth_of(r, model, q=true_q))["nees_per_dof"] == pytest.approx(
        0.5e-4, rel=1e-6
    )
    assert compare_with_truth(on_body(body, q, np.zeros((3, 52))), truth_of(r, model))["nees_per_dof"] is None


def test_the_truth_is_matched_by_time(body):
    model, _ = body
    q = np.array([model.integrate(model.neutral(), np.full(52, 0.01 * t)) for t in range(10)])
    r = on_body(body, q[4:], np.zeros((6, 52)))
    times = r.times_s[0] - 0.04 + 0.01 * np.arange(10) + 1e-9
    truth = truth_of(r, model, times_s=times, q=q, v=np.zeros((10, 52)), tau=np.zeros((10, 52)),
                     foot_wrench=np.zeros((10, 2, 6)))  # fmt: skip
    assert compare_with_truth(r, truth)["angle_rms_deg"] == pytest.approx(0.0, abs=1e-9)


def test_the_truth_of_another_capture_or_body_is_refused(body):
    model, _ = body
    r = on_body(body, np.tile(model.neutral(), (5, 1)), np.zeros((5, 52)))
    with pytest.raises(InvalidInput, match="no frame at"):
        compare_with_truth(r, truth_of(r, model, times_s=r.times_s + 0.1))
    with pytest.raises(InvalidInput, match="no frames"):
        compare_with_truth(r, truth_of(r, model, times_s=r.times_s[:0]))
    with pytest.raises(InvalidInput, match="3 dofs"):
        compare_with_truth(r, truth_of(r, model, v=np.zeros((5, 3))))


def test_axes_are_told_by_their_names():
    told = summarise(made_up(file_axes="x,z,y", file_axes_source="body"))["axes"]
    assert told == {"up": "y", "forward": "x", "mirrored": True, "source": "body"}
    assert summarise(made_up(file_axes="-z,x,-y", file_axes_source="default"))["axes"] == {
        "up": "-y",
        "forward": "-z",
        "mirrored": False,
        "source": "default",
    }


def test_moments_of_the_trunk_are_stated_by_level_and_way():
    moments = np.zeros((12, 2, 2, 3))
    moments[3, 0, 1, 0], moments[:, 1, 1, 0] = -141.0, 70.5
    tracked = np.ones(12, bool)
    tracked[11] = False
    moments[11] = 1e6
    r = with_trunk(trunk_moments=moments, tracked=tracked, trunk_moments_sd=np.full(moments.shape, 4.0))
    found = summarise(r)["trunk_moments"]
    assert list(found) == ["T12/L1", "L5/S1"]
    assert found["T12/L1"]["peak_nm_per_kg"] == 0.0
    assert found["L5/S1"] == {
        "peak_nm_per_kg": pytest.approx(2.0),
        "sd_nm": pytest.approx(4.0),
        "bottom_up_peak_nm_per_kg": pytest.approx(1.0),
        "bottom_up_sd_nm": pytest.approx(4.0),
        "difference_rms_nm_per_kg": pytest.approx(np.sqrt((10 + 9) / 11)),
    }
    moments[:, 1] = np.nan
    alone = summarise(with_trunk(trunk_moments=moments))["trunk_moments"]["L5/S1"]
    assert alone["bottom_up_peak_nm_per_kg"] is None and alone["difference_rms_nm_per_kg"] is None
    assert summarise(made_up())["trunk_moments"] == {}
