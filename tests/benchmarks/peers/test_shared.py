"""What all tools read: axes, loads by their columns, and the samples that are hidden."""

from types import SimpleNamespace

import numpy as np

from benchmarks.peers.hidden import error_mm, masked
from benchmarks.peers.residuals import filtered, norm_rms
from benchmarks.peers.shared import Loads, to_opensim


def test_axes_turn_without_mirroring():
    turned = to_opensim(np.eye(3))
    assert np.linalg.det(turned) == 1.0
    np.testing.assert_array_equal(to_opensim(np.array([1.0, 2.0, 3.0])), [1.0, 3.0, -2.0])


def test_loads_are_read_at_the_frames(tmp_path):
    columns = tuple((f"{s}_v", f"{s}_p", f"{s}_m") for s in "rl")
    names = [f"{start}{axis}" for foot in columns for start in foot for axis in "xyz"]
    times = np.array([0.0, 0.1, 0.2])
    values = np.outer(1.0 + times, np.arange(len(names)))
    rows = ["\t".join(map(str, row)) for row in np.column_stack([times, values]).tolist()]
    path = tmp_path / "loads.mot"
    head = ["loads", "version=1", "nRows=3", f"nColumns={len(names) + 1}", "inDegrees=no", "endheader"]
    path.write_text("\n".join([*head, "\t".join(["time", *names]), *rows]) + "\n")
    found = Loads(path, columns).at(np.array([0.05]))
    assert found.shape == (1, 2, 3, 3)
    np.testing.assert_allclose(found.ravel(), 1.05 * np.arange(18))


def test_errors_count_hidden_samples_only():
    true = np.zeros((4, 2, 3))
    hidden = np.array([[True, False], [False, False], [False, True], [False, False]])
    found = true.copy()
    found[0, 0], found[1, 0] = [0.003, 0.004, 0.0], [1.0, 0.0, 0.0]
    assert np.isnan(masked(true, hidden)[hidden]).all() and not np.isnan(masked(true, hidden)[~hidden]).any()
    np.testing.assert_allclose(error_mm(found, true, hidden), np.sqrt(12.5))


def test_a_low_pass_keeps_slow_motion_and_its_slopes():
    t = np.arange(400) / 100.0
    q = np.sin(2.0 * np.pi * 0.5 * t)[:, None]
    noisy = q + 0.01 * np.sin(2.0 * np.pi * 40.0 * t)[:, None]
    found = filtered(SimpleNamespace(q=noisy, markers_m=None), 100.0, 6.0)
    middle = slice(50, -50)
    np.testing.assert_allclose(found.q[middle], q[middle], atol=1e-3)
    np.testing.assert_allclose(found.a[middle], -((2 * np.pi * 0.5) ** 2) * q[middle], atol=0.2)
    assert norm_rms(np.array([[3.0, 4.0, 0.0], [0.0, 0.0, 0.0]])) == np.sqrt(12.5)
