"""Evidence of a live run, frame by frame: the verdict is that of the whole trial on the same frames."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.io.findings import Finding
from mbkf.io.subject import write_subject
from mbkf.io.unexplained import UnexplainedLoad
from mbkf.stream.run.setup import prepare
from mbkf.trial.checks import mass
from mbkf.trial.live.filter import live_inputs
from mbkf.trial.live.log import SUBJECT_FILE, LiveLog, LiveStream
from mbkf.trial.live.results import live_results
from mbkf.trial.live.running_evidence import RunningEvidence, with_causes
from mbkf.trial.preparation.settings import ReconstructSettings
from mbkf.trial.scale import scale
from mbkf.trial.verdict.evidence import Found, evidence_of
from mbkf.trial.verdict.judge import judge
from tests.captures import MASS_KG, made_capture
from tests.stream.scripted import frames_of

SETTINGS = ReconstructSettings(correct_markers=False)
CAPTURE = made_capture(70)


@pytest.fixture(scope="module")
def subject():
    return scale(made_capture(30, 0.0), mass_kg=MASS_KG)


@pytest.fixture(scope="module")
def run(subject, tmp_path_factory):
    """A run: its setup, the rows of its frames, its final result and its log."""
    stream, frames = frames_of(CAPTURE)
    setup = prepare(stream, subject, SETTINGS, True, lambda *_: None)
    folder, rows = tmp_path_factory.mktemp("run") / "log", []
    kept = LiveStream(stream.trial, stream.rate_hz, 0.0, CAPTURE.plates, (), stream.marker_names)
    log = LiveLog(folder, kept, setup.rows.dtype, {"filter": "dynamic"}, list(setup.names))
    reads = np.array([plate.force_n[::10] for plate in CAPTURE.plates])
    moments = np.array([plate.moment_nm[::10] for plate in CAPTURE.plates])
    origins = [plate.origin_m for plate in CAPTURE.plates]

    def answered(steps):
        for step in steps:
            measured = frames[step.number].markers_m[setup.columns]
            row, spread = setup.rows.row(step.number, measured, step.estimate, step.seconds)
            setup.rows.spread(row, spread)
            setup.rows.innovation(row, step.estimate)
            rows.append(row)

    for t, frame in enumerate(frames):
        plates = np.concatenate([reads[:, t], moments[:, t]], axis=1)
        plates[:, 3:] += np.cross(origins, plates[:, :3])
        ready = setup.frame(type("Ready", (), {"plates": plates})(), frame.markers_m[setup.columns])
        answered(setup.filter.push(t, ready))
    answered(setup.filter.finish())
    log.frames.append(np.concatenate(rows))
    samples = np.zeros(10 * CAPTURE.markers.frames, log.plates.dtype)
    samples["index"] = np.arange(len(samples))
    for k, plate in enumerate(CAPTURE.plates):
        samples["wrench"][:, k] = np.hstack([plate.force_n, plate.moment_nm])
    log.plates.append(samples)
    log.close()
    write_subject(subject, folder / SUBJECT_FILE)
    return setup, rows, live_results(folder), folder


def test_the_verdict_of_the_frames_so_far_is_that_of_the_whole_run(run, subject):
    setup, rows, result, _ = run
    running = RunningEvidence(setup.live, subject, 100.0)
    known = [running.push(row, True, False) for row in rows]
    assert running.frames == len(rows) and all(known)
    whole = evidence_of(replace(result, valid=np.ones(result.frames, bool)))
    found = Found((), (), (), whole.checks, whole.explained)
    assert running.verdict(found).parts == judge(whole).parts
    sums = running._sums
    assert [one.part for one in sums.fits()] == [one.part for one in whole.fits]
    for one, other in zip(sums.fits(), whole.fits, strict=True):
        assert (one.rms_mm, one.per_noise, one.nis) == pytest.approx(
            (other.rms_mm, other.per_noise, other.nis), rel=1e-6
        )
    expected = {name: float(result.angle_sd(name).mean()) for name in result.coordinate_names}
    assert sums.mean_sd() == pytest.approx(expected, rel=1e-5)


def test_frames_of_a_gap_are_frames_in_which_the_body_is_not_followed(run, subject):
    setup, rows, _, _ = run
    running = RunningEvidence(setup.live, subject, 100.0)
    for row in (*rows[:20], *rows[60:]):
        running.push(row, True, False)
    running.verdict(Found())
    assert (running.frames, running._sums.tracked) == (70, 30)


def test_loads_are_known_where_they_are_read_or_estimated_well(run, subject):
    setup, rows, _, _ = run
    running = RunningEvidence(setup.live, subject, 100.0)
    unasked, lost, beside = (rows[30].copy() for _ in range(3))
    unasked["footing"], lost["tracked"] = -9, False
    beside["footing"], beside["torque_sd"] = (1, -1), 1e3
    assert running.push(unasked, True, False) and not running.push(unasked, False, False)
    assert not running.push(lost, True, False) and not running.push(beside, False, False)
    well = beside.copy()
    well["torque_sd"] = 1.0
    assert RunningEvidence(setup.live, subject, 100.0).push(well, False, False)


def test_names_that_the_filter_took_up_count(run, subject):
    """Without them the markers lie elsewhere than the body has them."""
    setup, rows, _, _ = run
    order = np.arange(len(setup.names))
    a, b = setup.names.index("RKNE"), setup.names.index("LKNE")
    order[[a, b]] = b, a

    def rms_mm(order, exchanged):
        running = RunningEvidence(setup.live, subject, 100.0)
        for row in rows:
            put = row.copy()
            if exchanged:
                put["measured_m"][:, [a, b]] = row["measured_m"][:, [b, a]]
            running.push(put, True, False, order)
        running.verdict(Found())
        return {one.part: one.rms_mm for one in running._sums.fits()}["right_leg"]

    right = rms_mm(None, exchanged=False)
    assert rms_mm(order, exchanged=True) == pytest.approx(right)
    assert rms_mm(None, exchanged=True) > 10.0 * right


def test_a_wrong_mass_is_the_cause_of_vertical_forces():
    up, aside = (UnexplainedLoad(0.0, 1.0, force, 8.0, 0.1) for force in ((0, 0, 80.0), (80.0, 0, 0)))
    wrong = Finding(mass.NAME, 20.0, 1.0, "%", 5.0, "outside")
    assert [one.cause for one in with_causes([up, aside], [wrong])] == ["mass", ""]
    assert with_causes([up], [replace(wrong, verdict="inside")]) == (up,)


def test_bodies_of_a_stream_have_the_names_of_its_markers(subject):
    live = live_inputs(CAPTURE.markers.names, 100.0, CAPTURE.plates, subject, SETTINGS)
    assert RunningEvidence(live, subject, 100.0).verdict(Found()).overall == "do not use", (
        "nothing is shown yet"
    )


def test_a_part_that_bears_load_calls_for_a_look(run, subject):
    setup, rows, _, _ = run
    running = RunningEvidence(setup.live, subject, 100.0)
    for k, row in enumerate(rows):
        put = row.copy()
        put["support"] = 0.0
        put["support"][0, 0, 2] = 300.0 * (k > 30)
        running.push(put, True, False)
    verdict = running.verdict(Found())
    assert verdict.parts["trunk_loads"] == "look"
    assert any("bears up to 300 N" in one.found for one in verdict.reasons)
