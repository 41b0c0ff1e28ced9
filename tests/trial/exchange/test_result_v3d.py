"""Visual3D's text table: five lines of heading over the signals of the C3D file."""

import numpy as np
import pytest

from mbkf.trial.exchange.result_c3d import result_capture
from mbkf.trial.exchange.result_v3d import write_result_v3d
from tests.recordings import broken_walk


@pytest.fixture(scope="module")
def table(tmp_path_factory):
    """Columns by signal and component, and the types and folders of the signals."""
    path = tmp_path_factory.mktemp("v3d") / "walk_model.txt"
    write_result_v3d(broken_walk(), path)
    lines = [line.split("\t") for line in path.read_text().splitlines()]
    assert len({len(line) for line in lines}) == 1 and set(lines[0][1:]) == {"walk_model.c3d"}
    assert [line[0] for line in lines[:5]] == ["", "", "", "", "ITEM"]
    assert [line[0] for line in lines[5:]] == [str(k + 1) for k in range(broken_walk().frames)]
    values = np.array([[float(one) if one else np.nan for one in line[1:]] for line in lines[5:]])
    heads = list(zip(*(line[1:] for line in lines[1:5]), strict=True))
    return {(name, axis): values[:, k] for k, (name, _, _, axis) in enumerate(heads)}, {
        name: (kind, folder) for name, kind, folder, _ in heads
    }


def test_every_signal_of_the_c3d_file_is_there_in_si_units(table):
    columns, heads = table
    capture = result_capture(broken_walk())
    for k, name in enumerate(capture.markers.names):
        found = np.column_stack([columns[name, axis] for axis in "XYZ"])
        np.testing.assert_allclose(found, capture.markers.positions_m[:, k], atol=1e-8)
        assert heads[name] == ("TARGET", "ORIGINAL")
    for point in capture.derived:
        found = np.column_stack([columns[point.name, axis] for axis in "XYZ"])
        np.testing.assert_allclose(found, point.values, rtol=1e-8, atol=1e-12)
    assert len(columns) == 1 + 3 * (len(capture.markers.names) + len(capture.derived))


def test_types_are_visual3d_s(table):
    columns, heads = table
    assert heads["RKneeAngles"] == ("LINK_MODEL_BASED", "MBKF")
    assert heads["RGroundReactionForce"] == heads["RHJC"] == ("DERIVED", "MBKF")
    assert heads["TIME"] == ("FRAME_NUMBERS", "ORIGINAL")
    np.testing.assert_allclose(columns["TIME", "X"], broken_walk().times_s, atol=1e-9)
