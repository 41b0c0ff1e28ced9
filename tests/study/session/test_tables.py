"""Every curve as a row for each per cent; files read back as they were written."""

import numpy as np
import pyarrow.csv as pa_csv
import pyarrow.parquet as pq
import pytest

from mbkf.errors import InvalidInput
from mbkf.study.session.tables import SCHEMA, curves_table, write_session_curves
from tests.study.session.sessions import session


def test_every_cycle_has_every_curve():
    table, (gait,) = curves_table(session(1)), session(1).gaits
    assert table.schema == SCHEMA
    assert table.num_rows == 101 * sum(len(side.cycles) * len(side.curves) for side in gait.sides)
    rows = table.to_pydict()
    chosen = [
        k
        for k in range(table.num_rows)
        if (rows["side"][k], rows["quantity"][k], rows["name"][k]) == ("left", "torque", "knee_angle")
    ]
    left = gait.sides[1]
    curve = left.curves[next(key for key in left.curves if key == ("torque", "knee_angle"))]
    np.testing.assert_allclose([rows["value"][k] for k in chosen], curve.values.ravel(), rtol=1e-6)
    assert [rows["percent"][k] for k in chosen][:101] == list(range(101))
    assert rows["duration_s"][chosen[0]] == pytest.approx(left.cycles[0].cycle.seconds, rel=1e-6)


def test_files_hold_the_table(tmp_path):
    for name, read in (("c.csv", pa_csv.read_csv), ("c.parquet", pq.read_table)):
        write_session_curves(session(1), tmp_path / name)
        found = read(tmp_path / name)
        assert found.column_names == SCHEMA.names and found.num_rows == curves_table(session(1)).num_rows
        np.testing.assert_allclose(
            found["value"].to_numpy(), curves_table(session(1))["value"].to_numpy(), rtol=1e-6
        )
    with pytest.raises(InvalidInput, match=r"written as \.csv or \.parquet"):
        write_session_curves(session(1), tmp_path / "c.xlsx")
