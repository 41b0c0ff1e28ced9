"""A filter's way through a trial is the one that a track records, restarts included."""

import numpy as np

from mbkf.filters.estimate import Recording
from mbkf.filters.kinematic.filter import KinematicFilter
from mbkf.filters.kinematic.settings import KinematicSettings
from mbkf.filters.kinematic.tracking import KinematicTracking
from mbkf.filters.tracking import track
from mbkf.filters.tracking_loop import followed
from tests.motions import marker_positions, protocol_sensor, reference_model, smooth_motion

MODEL = reference_model()
FRAMES, RATE_HZ = 70, 100.0


def test_it_is_what_a_track_records():
    sensor, _ = protocol_sensor(MODEL)
    markers = marker_positions(
        sensor, smooth_motion(MODEL, np.random.default_rng(1)).frames(FRAMES, RATE_HZ)[0]
    )
    markers[:3] = np.nan
    markers[20:50] = np.nan
    recording = Recording(markers, np.zeros((FRAMES, 0, 6)), 1.0 / RATE_HZ)
    everywhere = np.zeros(MODEL.nv, dtype=bool)
    kalman = KinematicFilter(sensor, np.full(36, 0.005), recording.dt_s, everywhere, KinematicSettings())
    tracking = KinematicTracking(kalman)
    recorded = track(tracking, recording)
    course = list(followed(tracking, recording))
    assert [t for t, _, _ in course] == list(range(3, FRAMES))
    assert tuple(t for t, estimate, _ in course if estimate.started) == recorded.starts
    assert len(recorded.starts) == 2
    np.testing.assert_array_equal([estimate.q for _, estimate, _ in course], recorded.q[3:])
    assert all(seconds > 0.0 for _, _, seconds in course)


def test_an_estimate_that_is_no_person_is_given_to_nobody_and_the_next_frame_starts_anew():
    sensor, _ = protocol_sensor(MODEL)
    markers = marker_positions(
        sensor, smooth_motion(MODEL, np.random.default_rng(1)).frames(FRAMES, RATE_HZ)[0]
    )
    recording = Recording(markers, np.zeros((FRAMES, 0, 6)), 1.0 / RATE_HZ)
    everywhere = np.zeros(MODEL.nv, dtype=bool)
    kalman = KinematicFilter(sensor, np.full(36, 0.005), recording.dt_s, everywhere, KinematicSettings())

    class Thrown(KinematicTracking):
        """Frame 30 throws it."""

        def step(self, before, recording, t, prediction=None):
            found = super().step(before, recording, t, prediction)
            return found._replace(v=1e6 * np.ones_like(found.v)) if t == 30 else found

    found = track(Thrown(kalman), recording)
    assert np.flatnonzero(~found.known).tolist() == [30]
    assert found.starts == (0, 31)
    assert np.isnan(found.q[30]).all() and not found.tracked[30]
    assert np.isfinite(found.q[31:]).all() and found.tracked[31:].all()
