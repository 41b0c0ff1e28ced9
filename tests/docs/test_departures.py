"""The table of departures is complete, and the printed forms fail where it says so."""

import re
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mbkf.imu.madgwick import MadgwickFilter, MadgwickSettings
from mbkf.labelling.assignment import AssignmentSettings, assign
from mbkf.model.human import HumanModel
from mbkf.model.protocol import load_protocol
from mbkf.sensors.marker_sensor import MarkerSensor
from mbkf.trial.observability import followed_markers

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs/theory/departures.md"
SAID = re.compile(r"[Dd]eparts? from ((?:thesis|Madgwick|stride) .{0,40})")
COLUMNS = 6


def table_rows():
    """Cells of the first table of the page, by source."""
    part = PAGE.read_text(encoding="utf-8").partition("## Formulas")[2].partition("\n## ")[0]
    lines = [line.strip("| \n").split(" | ") for line in part.splitlines() if line.startswith("| ")]
    return {cells[0]: cells for cells in lines[1:]}


ROWS = table_rows()


def prose(path):
    """Text of a file without line breaks and comment signs."""
    return re.sub(r"\s*\n\s*#?\s*", " ", path.read_text(encoding="utf-8"))


def source_of(said):
    """Row that a text after "departs from" begins with; the text itself where the table has no such row."""
    fits = [key for key in ROWS if re.match(rf"{re.escape(key)}(?!\d)(?!\.\d)", said)]
    return max(fits, key=len, default=said)


def departures_in_code():
    """Sources from which each file says that it departs."""
    files = [path for room in ("mbkf", "benchmarks") for path in (ROOT / room).rglob("*.py")]
    said = ((path.relative_to(ROOT).as_posix(), text) for path in files for text in SAID.findall(prose(path)))
    return {(source_of(text), name) for name, text in said}


def test_the_table_and_the_code_name_the_same_departures():
    in_table = {(key, cells[4].strip("`")) for key, cells in ROWS.items()}
    assert all(len(cells) == COLUMNS for cells in ROWS.values())
    assert departures_in_code() == in_table


@pytest.mark.parametrize("source", ROWS)
def test_every_departure_has_a_check_that_exists(source):
    file, _, name = ROWS[source][5].strip("`").partition("::")
    assert re.search(rf"^def {name}\(", (ROOT / file).read_text(encoding="utf-8"), re.MULTILINE)


@pytest.mark.parametrize(
    ("said", "source"),
    [
        ("thesis eq. 4.11, which", "thesis eq. 4.11"),
        ("thesis eq. 4.1, which", "thesis eq. 4.1"),
        ("thesis eq. 4.1", "thesis eq. 4.1"),
        ("thesis section 4.1.4.1, where", "thesis section 4.1.4.1"),
        ("thesis eq. 9.9", "thesis eq. 9.9"),
    ],
)
def test_the_longest_source_is_meant(said, source):
    assert source_of(said) == source


def test_the_code_is_read_across_lines(tmp_path):
    file = tmp_path / "x.py"
    file.write_text("# This departs from\n# thesis eq. 4.6 in that.\n", encoding="utf-8")
    assert [source_of(text) for text in SAID.findall(prose(file))] == ["thesis eq. 4.6"]


# The thesis's kinematics: A = Rz(γ) Ry(β) Rx(α) of thesis eq. 3.6 and ω = W̄ (α̇, β̇, γ̇) of thesis eq. 3.26.


def turned(angles):
    a, b, c = angles
    return Rotation.from_euler("ZYX", [c, b, a]).as_matrix()


def rate_matrix(angles):
    a, b, _ = angles
    return np.array(
        [
            [1.0, 0.0, -np.sin(b)],
            [0.0, np.cos(a), np.sin(a) * np.cos(b)],
            [0.0, -np.sin(a), np.cos(a) * np.cos(b)],
        ]
    )


def test_the_thesis_angles_are_singular_for_a_level_thigh():
    """A thigh hangs along −z; turned about y by 90° it is level, and two of its three angles turn about one axis."""
    for b, expected in ((0.3, np.cos(0.3)), (-np.pi / 2, 0.0)):
        assert np.linalg.det(rate_matrix([0.4, b, -0.2])) == pytest.approx(expected, abs=1e-12)
    np.testing.assert_allclose(turned([0.0, -np.pi / 2, 0.0]) @ [0.0, 0.0, -1.0], [1.0, 0.0, 0.0], atol=1e-12)
    model = HumanModel.scaled()
    q, hip = model.neutral(), model.joint("right_thigh")
    q[hip.q] = Rotation.from_euler("y", -np.pi / 2).as_quat()
    steps = [model.difference(q, model.integrate(q, step)) for step in 1e-3 * np.eye(model.nv)]
    np.testing.assert_allclose(steps, 1e-3 * np.eye(model.nv), atol=1e-12)


def by_rates(matrix, angles, rates):
    """∂(Ṙ ż)/∂ż of a velocity matrix R(z), and 2 Ṙ."""

    def change(v):
        step = 1e-4
        return (matrix(angles + step * v) - matrix(angles - step * v)) / (2.0 * step)

    units = 0.1 * np.eye(3)
    slope = [(change(rates + e) @ (rates + e) - change(rates - e) @ (rates - e)) / 0.2 for e in units]
    return np.stack(slope, axis=1), 2.0 * change(rates)


def test_twice_the_rate_of_r_holds_for_points_and_not_for_angular_velocities():
    """Thesis eq. 3.48, for the rows of a centre of mass (G of thesis eq. 3.20) and of ω (W̄)."""
    angles, rates, lever = np.array([0.4, -0.3, 0.8]), np.array([1.0, -2.0, 1.5]), np.array([0.1, 0.05, -0.4])

    def point(z):
        step = 1e-3 * np.eye(3)
        return np.stack([(turned(z + e) - turned(z - e)) @ lever / 2e-3 for e in step], axis=1)

    found, printed = by_rates(point, angles, rates)
    np.testing.assert_allclose(found, printed, atol=1e-5)
    found, printed = by_rates(rate_matrix, angles, rates)
    assert np.abs(found - printed).max() > 0.5 * np.abs(printed).max()


def nearest_first(predicted, points):
    """Point of each marker by thesis 4.1.3: nearest pairs first."""
    squared = ((predicted[:, None] - points) ** 2).sum(axis=-1)
    found = np.full(len(predicted), -1)
    for k in np.argsort(squared, axis=None):
        i, j = np.unravel_index(k, squared.shape)
        if found[i] < 0 and j not in found:
            found[i] = j
    return found


def test_nearest_pairs_first_exchange_two_markers_that_all_pairs_together_keep():
    """Two markers 4 cm apart, moved by 3 cm along their line: one point lies beside the wrong prediction."""
    predicted = np.array([[0.0, 0.0, 1.0], [0.04, 0.0, 1.0]])
    points = predicted + np.array([0.03, 0.0, 0.0])
    np.testing.assert_array_equal(nearest_first(predicted, points), [1, 0])
    spread = 0.02**2 * np.tile(np.eye(3), (2, 1, 1))
    together = assign(predicted, points, lambda chosen: spread[chosen], AssignmentSettings())
    np.testing.assert_array_equal(together, [0, 1])


def test_the_rule_of_sides_names_the_wrong_foot_of_a_person_who_faces_back():
    """The ten lowest markers are the feet's, the five of them with the least y the right foot's: as one faces +x."""
    markers = followed_markers(load_protocol("reference36"))
    model = HumanModel.scaled()
    places = np.array([one.position_m for one in markers])
    sensor = MarkerSensor(model, [one.segment for one in markers], places)
    right = [one.segment in {"right_foot", "right_toes"} for one in markers]
    for yaw, sides in ((0.0, True), (np.pi, False)):
        q = model.neutral()
        q[model.root.q][3:] = Rotation.from_euler("z", yaw).as_quat()
        points = sensor.positions(q)
        lowest = np.argsort(points[:, 2])[:10]
        called_right = lowest[np.argsort(points[lowest, 1])[:5]]
        assert all(right[k] == sides for k in called_right)


def printed_error(q, acc, field, mag):
    """Madgwick eq. 28 as printed: a_x in the third row, a product in the last."""
    q0, q1, q2, q3 = q
    b1, b3 = field
    return np.array(
        [
            2 * (q1 * q3 - q0 * q2) - acc[0],
            2 * (q0 * q1 + q2 * q3) - acc[1],
            2 * (0.5 - q1**2 - q2**2) - acc[0],
            2 * b1 * (0.5 - q2**2 - q3**2) + 2 * b3 * (q1 * q3 - q0 * q2) - mag[0],
            2 * b1 * (q1 * q2 - q0 * q3) + 2 * b3 * (q0 * q1 + q2 * q3) - mag[1],
            2 * b1 * (q0 * q2 + q1 * q3) + 2 * b3 * 2 * b1 * (0.5 - q1**2 - q2**2) - mag[2],
        ]
    )


def test_madgwicks_printed_error_does_not_vanish_at_the_true_attitude():
    field, attitude = np.array([0.4, -0.9]), Rotation.from_euler("ZYX", [0.7, 0.3, -0.5])
    acc, mag = attitude.inv().apply([[0.0, 0.0, 1.0], [field[0], 0.0, field[1]]])
    x, y, z, w = attitude.as_quat()
    printed = np.abs(printed_error((w, x, y, z), acc, field, mag))
    np.testing.assert_allclose(printed[[0, 1, 3, 4]], 0.0, atol=1e-12)
    assert printed[[2, 5]].min() > 0.1
    *_, last = followed(MadgwickSettings(0.2), np.zeros(3), acc, mag, 1000)
    assert (attitude.inv() * Rotation.from_quat(last.quaternion)).magnitude() < 0.01


DT_S = 0.01


def followed(gains, rate, acc, mag, count, *, forget=False):
    """States of the filter from level and north, for readings that stay; ``forget``: without the bias before."""
    kalman = MadgwickFilter(DT_S, gains)
    state = kalman.begin_at(np.array([0.0, 0.0, 0.0, 1.0]))
    for _ in range(count):
        state = kalman.step(state._replace(bias=(0.0, 0.0, 0.0)) if forget else state, rate, acc, mag)
        yield state


def test_madgwicks_printed_correction_leaves_a_bias_where_it_is():
    """Without the bias of the sample before, a step corrects its own sample alone, as Madgwick eq. 34 has it."""
    bias, gains = np.array([0.02, -0.015, 0.01]), MadgwickSettings(0.05, 0.01)
    still = bias, np.array([0.0, 0.0, 1.0]), np.array([0.5, 0.0, -0.8])
    *_, ours = followed(gains, *still, 3000)
    *_, printed = followed(gains, *still, 3000, forget=True)
    assert np.linalg.norm(ours.gyro_bias - bias) < 0.3 * np.linalg.norm(bias)
    assert 0.0 < np.linalg.norm(printed.gyro_bias) < 0.02 * np.linalg.norm(bias)


def test_the_printed_rates_are_twice_too_large_and_their_matrix_is_turned_round():
    """Madgwick eqs. 39–43 on a turn of known angular velocity in the sensor's axes."""
    rate, dt_s, start = np.array([0.3, -0.5, 0.7]), 1e-6, Rotation.from_euler("ZYX", [0.7, 0.3, -0.5])
    before, after = start.as_matrix(), (start * Rotation.from_rotvec(dt_s * rate)).as_matrix()
    change = (after - before) / dt_s
    x, y, z = rate
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    np.testing.assert_allclose(change.T @ before, -cross, atol=1e-5)
    product = before.T @ change
    np.testing.assert_allclose(product, cross, atol=1e-5)
    printed = product[[2, 0, 1], [1, 2, 0]] - product[[1, 2, 0], [2, 0, 1]]
    np.testing.assert_allclose(printed, 2.0 * rate, atol=1e-5)


def test_a_gain_by_the_printed_root_depends_on_the_unit():
    """√(3/4) σ in deg/s is that in rad/s times 180/π; √(3/4 × σ) is not."""
    noise = 0.01
    assert np.sqrt(0.75) * np.rad2deg(noise) == pytest.approx(np.rad2deg(np.sqrt(0.75) * noise))
    assert np.sqrt(0.75 * np.rad2deg(noise)) < 0.2 * np.rad2deg(np.sqrt(0.75 * noise))
