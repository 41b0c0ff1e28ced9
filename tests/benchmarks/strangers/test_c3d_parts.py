"""Parts of a C3D file make the file again, and each of them can be changed alone."""

import numpy as np

from benchmarks.strangers.c3d_parts import C3dParts, Record, floats
from mbkf.io.c3d_decode import decode
from mbkf.io.c3d_layout import check_layout
from tests.io.c3d_builder import standing_points
from tests.io.c3d_bytes import c3d_bytes

CONTENT = c3d_bytes(standing_points(12, 5), np.ones((12, 3, 2)))


def test_the_parts_of_a_file_make_the_file():
    assert C3dParts.of(CONTENT).encoded() == CONTENT


def test_a_record_more_moves_the_data_and_leaves_them_alone(tmp_path):
    parts = C3dParts.of(CONTENT)
    parts.records.append(Record(1, b"LONG", floats(np.zeros(200))))
    parts.put("POINT", "RATE", floats([50.0]))
    path = tmp_path / "x.c3d"
    path.write_bytes(parts.encoded())
    content = decode(path, check_layout(path))
    assert len(path.read_bytes()) == len(CONTENT) + 1024
    np.testing.assert_allclose(content.points, standing_points(12, 5), rtol=1e-6)
    assert content.parameters.number("POINT", "RATE") == 50.0
