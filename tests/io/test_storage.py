"""Tables of OpenSim in every header dialect, and back."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from mbkf.errors import FileFormatError, ShapeError, UnknownName
from mbkf.io.storage import Table, read_storage, write_storage

ROWS = "0.0\t1\t2\n0.5\t3\tnan\n1.0\t-5e-3\t6\n"
DIALECTS = {
    "opensim": (
        "Coordinates\nversion=1\nnRows=3\nnColumns=3\ninDegrees=yes\n\nUnits are S.I.\n\nendheader\n",
        True,
    ),
    "tabs": (
        "a.mot\t\t\nversion=1\t\t\nnRows=3\t\t\nnColumns=3\t\t\ninDegrees=no\t\t\nendheader\t\t\n",
        False,
    ),
    "simm": ("name grf.mot\t\ndatacolumns 3\ndatarows 3\nrange 0.0 1.0\nendheader\n", False),
    "adapter": ("inDegrees=no\nDataType=double\nversion=3\nOpenSimVersion=4.4\nendheader\n", False),
}
quick = settings(max_examples=20, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


def read(tmp_path, content: str) -> Table:
    path = tmp_path / "a.mot"
    path.write_text(content)
    return read_storage(path)


@pytest.mark.parametrize("dialect", DIALECTS)
@pytest.mark.parametrize("names", ["time\ta\tb", "   time\t  a\t b\t\t", "time a b"])
def test_dialects(tmp_path, dialect, names):
    header, degrees = DIALECTS[dialect]
    table = read(tmp_path, f"{header}{names}\n{ROWS}\n\n")
    assert table.names == ("a", "b")
    assert table.in_degrees == degrees
    np.testing.assert_array_equal(table.times_s, [0.0, 0.5, 1.0])
    np.testing.assert_array_equal(table.columns, [[1, 2], [3, np.nan], [-0.005, 6]])
    np.testing.assert_array_equal(table.column("a"), [1.0, 3.0, -0.005])
    with pytest.raises(UnknownName, match="column 'c'"):
        table.column("c")


def test_titles(tmp_path):
    titles = {
        name: read(tmp_path, f"{header}time\ta\tb\n{ROWS}").title for name, (header, _) in DIALECTS.items()
    }
    assert titles == {"opensim": "Coordinates", "tabs": "a.mot", "simm": "grf.mot", "adapter": ""}


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        ("a\nb\nc\n", "no line 'endheader'"),
        ("title\nendheader\n", "no column names"),
        ("title\nendheader\nframe\ta\n1\t2\n", "line 3.*'time'"),
        ("title\nendheader\ntime\ta\n", "no rows"),
        ("title\nendheader\ntime\ta\n0\t1\n1\n", "line 5.*1 values for 2 columns"),
        ("title\nendheader\ntime\ta\n0\t1\n1\tx\n", "line 5.*not a number"),
        ("title\nnRows=5\nendheader\ntime\ta\n0\t1\n", "cut short: 5 rows promised, 1 present"),
    ],
)
def test_broken_tables_are_refused(tmp_path, content, reason):
    with pytest.raises(FileFormatError, match=reason):
        read(tmp_path, content)


def test_missing_file(tmp_path):
    with pytest.raises(FileFormatError, match="no such file"):
        read_storage(tmp_path / "none.mot")


@quick
@given(
    columns=arrays(np.float64, (4, 3), elements=st.floats(-1e6, 1e6)),
    steps=arrays(np.float64, 4, elements=st.floats(1e-4, 1.0)),
    degrees=st.booleans(),
)
def test_round_trip(tmp_path, columns, steps, degrees):
    table = Table(
        ("a", "b", "c/d"), np.cumsum(steps), columns, degrees, "Title", {"units": "deg and m", "nRows": "9"}
    )
    write_storage(table, tmp_path / "a.sto")
    back = read_storage(tmp_path / "a.sto")
    assert (back.names, back.in_degrees, back.title) == (table.names, degrees, "Title")
    assert (back.header["units"], back.header["nrows"], back.header["ncolumns"]) == ("deg and m", "4", "4")
    np.testing.assert_allclose(back.times_s, table.times_s, rtol=1e-9)
    np.testing.assert_allclose(back.columns, columns, rtol=1e-11, atol=1e-300)


def test_shape_is_checked():
    with pytest.raises(ShapeError, match=r"\(2, 1\)"):
        Table(("a",), np.zeros(2), np.zeros((2, 2)))


@pytest.mark.parametrize(
    ("name", "shape", "degrees"),
    [
        ("gait2354_walk/reference/subject01_walk1_ik.mot", (73, 23), True),
        ("gait2354_walk/reference/inverse_dynamics.sto", (73, 23), False),
        ("rajagopal_walk_run/grf_run.mot", (5091, 18), False),
        ("rajagopal_walk_run/reference_walk/coordinates_rra.sto", (1350, 31), False),
        ("synthetic_exact_truth/subject01_coordinates_TRUTH.sto", (223, 33), False),
    ],
)
def test_reference_tables(real_data, name, shape, degrees):
    table = read_storage(real_data / name)
    assert (table.columns.shape, table.in_degrees) == (shape, degrees)
    assert (np.diff(table.times_s) > 0.0).all()
