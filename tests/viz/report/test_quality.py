"""The quality section: verdicts follow their bounds, remarks and labels are shown."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.conventions import GRAVITY_M_S2
from mbkf.io.unexplained import UnexplainedLoad
from mbkf.trial.results.summary import summarise
from mbkf.viz.report.quality import BAD, CARE, GOOD, NONE, quality_section, verdicts
from tests.recordings import broken_walk, walk


def judged(r, **changes):
    return {v.title: v for v in verdicts(r, {**summarise(r), **changes})}


def test_a_good_result_is_called_good():
    found = judged(walk())
    assert {v.kind for title, v in found.items() if title != "Markers missing"} == {GOOD}
    assert found["Residual force"].value == "1.7 N", "one newton in each of three axes"


@pytest.mark.parametrize(
    ("changes", "title", "kind"),
    [
        ({"marker_rms_mm": 14.0}, "Marker error", GOOD),
        ({"marker_rms_mm": 16.0}, "Marker error", CARE),
        ({"marker_rms_mm": 38.0}, "Marker error", BAD),
        ({"marker_max_mm": 41.0}, "Marker error", CARE),
        ({"marker_rms_mm": None}, "Marker error", NONE),
        ({"nis_per_dof": 1.7}, "Innovation (NIS)", CARE),
        ({"nis_per_dof": 0.3}, "Innovation (NIS)", NONE),
        ({"nis_per_dof": None}, "Innovation (NIS)", NONE),
        ({"residual_force_rms_n": None}, "Residual force", NONE),
    ],
)
def test_verdicts_follow_their_bounds(changes, title, kind):
    assert judged(walk(), **changes)[title].kind == kind


@pytest.mark.parametrize(("rms_mm", "kind"), [(38.0, GOOD), (45.0, CARE), (52.0, BAD)])
def test_keypoints_are_judged_by_their_noise(rms_mm, kind):
    r = walk()
    markers = tuple(replace(m, noise_m=0.02, correlated_m=0.01, correlation_s=0.3) for m in r.subject.markers)
    r = replace(r, subject=replace(r.subject, markers=markers))
    assert judged(r, marker_rms_mm=rms_mm, marker_max_mm=110.0)["Marker error"].kind == kind


def test_an_unexplained_force_is_bad_and_none_is_good():
    assert "Unexplained force" not in judged(walk())
    force = np.tile([0.0, 0.0, 0.03 * 9.80665 * walk().subject.mass_kg], (walk().frames, 1))
    force[0] = np.nan
    explained = replace(walk(), unexplained_force_n=force)
    tile = judged(explained)["Unexplained force"]
    assert (tile.kind, tile.value) == (GOOD, "3.0 %")
    seat = UnexplainedLoad(1.2, 9.8, (0.0, 0.0, 590.0), 8.0, 0.82, "", "a seat")
    tile = judged(replace(explained, unexplained=(seat, replace(seat, vector_n=(0.0, 0.0, 60.0)))))[
        "Unexplained force"
    ]
    assert (tile.kind, tile.value) == (BAD, "590 N")
    assert tile.remark == "upward, 1.20 to 9.80 s; 1 more below"


def test_only_a_filter_that_imposes_newtons_law_corrects():
    found = {name: judged(replace(walk(), filter=name)) for name in ("kinematic", "torque", "dynamic")}
    assert (
        "Residual force" in found["kinematic"] and "small" not in found["kinematic"]["Residual force"].remark
    )
    assert "small in any case" in found["torque"]["Residual force after correction"].remark
    assert "estimates it as a state" in found["dynamic"]["Residual force"].remark


def test_residuals_are_stated_by_body_weight():
    weight_n = GRAVITY_M_S2 * walk().subject.mass_kg
    found = judged(walk(), residual_force_rms_n=0.05 * weight_n, residual_moment_rms_nm=0.03 * weight_n)
    assert "5.0 % of body weight" in found["Residual force"].remark
    assert "a lever of 30 mm" in found["Residual moment"].remark


def test_one_large_residual_is_noticed():
    r = walk()
    force, moment = r.residual_force_n.copy(), r.residual_moment_nm.copy()
    force[50], moment[50] = 60.0, 20.0
    found = judged(replace(r, residual_force_n=force, residual_moment_nm=moment))
    assert found["Residual force"].kind == found["Residual moment"].kind == CARE
    unseen = r.measured.copy()
    unseen[50] = False
    found = judged(replace(r, residual_force_n=force, residual_moment_nm=moment, measured=unseen))
    assert found["Residual force"].kind == GOOD, "only frames with every contact measured are judged"


def test_a_body_that_does_not_fit_has_no_green_tick():
    found = judged(walk(), marker_rms_mm=38.0)
    assert GOOD not in {v.kind for v in found.values()}
    assert "has no meaning" in found["Residual force"].remark
    page = quality_section(walk(), {**summarise(walk()), "marker_rms_mm": 38.0}, None)
    assert "✓" not in page
    assert 'class="tile bad"' in page


@pytest.mark.parametrize(("lost", "kind"), [(0, GOOD), (2, CARE), (20, BAD)])
def test_untracked_frames_turn_the_tick(lost, kind):
    r = walk()
    tracked = np.arange(r.frames) >= lost
    found = {v.title: v for v in verdicts(replace(r, tracked=tracked), summarise(r))}
    assert found["Frames tracked"].kind == kind
    assert (found["Marker error"].kind == GOOD) == (kind != BAD)


@pytest.mark.parametrize(("explained", "kind"), [(1.0, NONE), (0.97, CARE), (0.6, CARE), (0.59, BAD)])
def test_ignored_markers_are_shown_where_there_are_any(explained, kind):
    names = {"X": "not known", "Y": "computed", "Z": "not known"}
    found = judged(walk(), markers_ignored=names, markers_explained=explained)["Markers ignored"]
    assert (found.kind, found.value) == (kind, "3")
    assert "X, Z (not known); Y (computed)" in found.remark
    assert "Markers ignored" not in judged(walk(), markers_ignored={})
    assert "Markers ignored" not in judged(walk())


def test_losses_are_told():
    found = judged(broken_walk())
    assert found["Frames tracked"].kind == CARE
    assert found["Markers missing"].remark == "longest gap of one marker 0.30 s"


def test_remarks_truth_and_labels():
    r = walk()
    summary = {**summarise(r), "truth": {"angle_rms_deg": 1.25, "nees_per_dof": None}}
    labels = {
        "assigned_fraction": 0.99, "ghosts_dropped": 7, "swaps_repaired": 0, "correct_fraction": 0.9987,
        "wrong_fraction": 0.0, "missed_fraction": 0.0013, "ghosts_per_frame": [1] * r.frames,
    }  # fmt: skip
    text = quality_section(r, summary, labels)
    for words in ("known truth", "1.25 °", "99.870 % correct", "ghosts dropped", "a remark with &lt;b&gt;"):
        assert words in text
    assert "ghosts dropped" not in quality_section(r, summary, {**labels, "ghosts_per_frame": [1, 2]})
    assert "No remarks." in quality_section(replace(r, warnings=()), summary, None)


def test_a_result_without_markers_shows_none_of_them():
    """Motion from inertial sensors alone."""
    r = walk()
    none = replace(
        r,
        marker_names=(),
        measured_m=r.measured_m[:, :0],
        predicted_m=r.predicted_m[:, :0],
        hidden=r.hidden[:, :0],
        rejected=r.rejected[:, :0],
        marker_nis=None,
        marker_spread_m=None,
    )
    assert not any("Marker" in title for title in judged(none))
    text = quality_section(none, summarise(none), None)
    assert "Marker error" not in text and "<h3>Markers</h3>" not in text and "Innovation squared" in text
