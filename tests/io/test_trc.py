"""TRC files in and out, however untidy their header."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from mbkf.errors import FileFormatError, InvalidInput, UnknownName
from mbkf.io.capture_options import CaptureOptions
from mbkf.io.records import MarkerTrajectories
from mbkf.io.trc import read_trc, write_trc

TITLES = "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames"
TIDY = "50\t50\t3\t2\tmm\t50\t1\t3"
ROWS = [
    "1\t0.00\t100\t1500\t-50\t120\t20\t60",
    "2\t0.02\t101\t1501\t-51\t\t\t",
    "3\t0.04\t0\t0\t0\tNaN\t21\t61",
]
quick = settings(max_examples=20, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


def text(header=TIDY, names="Frame#\tTime\tHead\t\t\tL.Toe Tip\t\t", rows=ROWS, titles=TITLES) -> str:
    lines = [
        "PathFileType\t4\t(X/Y/Z)\ta.trc",
        titles,
        header,
        names,
        "\t\tX1\tY1\tZ1\tX2\tY2\tZ2",
        "",
        *rows,
    ]
    return "\n".join(lines) + "\n"


def read(tmp_path, content: str, **options):
    path = tmp_path / "a.trc"
    path.write_text(content)
    return read_trc(path, CaptureOptions(**options))


def check_values(capture):
    markers = capture.markers
    assert markers.names == ("Head", "L.Toe Tip")
    assert (markers.rate_hz, markers.start_time_s) == (50.0, 0.0)
    np.testing.assert_allclose(markers.positions_m[0], [[0.1, 0.05, 1.5], [0.12, -0.06, 0.02]])
    np.testing.assert_array_equal(markers.present, [[True, True], [True, False], [False, False]])


@pytest.mark.parametrize(
    ("header", "shifted"),
    [
        (TIDY, False),
        ("  50\t50\t 3\t2\t  mm\t50\t1\t3\t\t\t\t", False),
        ("  50.0\t\t  50.0\t\t    3\t\t     2\t\t mm\t  50.0\t      1\t    3", True),
        ("50 50 3 2 mm 50 1 3", True),
        ("50\t50\t\t3\t2\tmm", True),
    ],
)
def test_headers_are_read_by_order(tmp_path, header, shifted):
    capture = read(tmp_path, text(header))
    check_values(capture)
    assert any("shifted" in note for note in capture.notes) == shifted


@pytest.mark.parametrize(
    "names",
    [
        "Frame#\tTime\t\tHead\t\t\tL.Toe Tip",
        "Frame#\tTime\tHead\t\t\tL.Toe Tip\t\t\t\t\t\t",
        "Frame#\tTime\tHead\tL.Toe Tip",
    ],
)
def test_tabs_between_names_do_not_matter(tmp_path, names):
    check_values(read(tmp_path, text(names=names)))


def test_trailing_tabs_blank_rows_and_missing_last_cells(tmp_path):
    rows = ["\t\t\t\t\t\t\t", ROWS[0] + "\t\t\t", "", "2\t0.02\t101\t1501\t-51", ROWS[2]]
    check_values(read(tmp_path, text(rows=rows)))


def test_rows_that_a_tab_indents(tmp_path):
    check_values(read(tmp_path, text(rows=["\t" + row for row in ROWS])))
    check_values(read(tmp_path, text(rows=[row[1:] for row in ROWS])))  # blank numbers of frames


def test_blanks_instead_of_tabs(tmp_path):
    rows = ["1 0.00 100 1500 -50 120 20 60", "2 0.02 101 1501 -51 NaN NaN NaN", "3 0.04 0 0 0 nan 21 61"]
    capture = read(tmp_path, text(names="Frame# Time Head Toe", rows=rows))
    assert capture.markers.names == ("Head", "Toe")
    np.testing.assert_array_equal(capture.markers.present, [[True, True], [True, False], [False, False]])


@pytest.mark.parametrize(
    "names", ["Frame#\tTime     Head     L.Toe Tip   ", "Frame# Time   Head    L.Toe Tip  "]
)
def test_names_that_blanks_align_may_hold_single_blanks(tmp_path, names):
    check_values(read(tmp_path, text(names=names)))


def test_names_between_single_blanks_after_tabs(tmp_path):
    assert read(tmp_path, text(names="Frame#\tTime Head Toe")).markers.names == ("Head", "Toe")


def test_decimal_commas(tmp_path):
    check_values(
        read(tmp_path, text(TIDY.replace("50", "50,0"), rows=[row.replace(".", ",") for row in ROWS]))
    )
    with pytest.raises(FileFormatError, match=r"line 8.*not a number"):
        read(tmp_path, text(rows=[ROWS[0], ROWS[1].replace("1501", "1,501"), ROWS[2]]))


def test_one_subjects_name_is_taken_off_and_two_are_kept(tmp_path):
    one, two = ("Frame#\tTime\tAnna:Head\t\t\t" + toe for toe in ("Anna:L.Toe Tip", "Bea:L.Toe Tip"))
    check_values(read(tmp_path, text(names=one)))
    assert read(tmp_path, text(names=two)).markers.names == ("Anna:Head", "Bea:L.Toe Tip")


def test_comments_and_lines_of_the_file_in_messages(tmp_path):
    commented = text(rows=[ROWS[0], "# a pause", *ROWS[1:]]).replace("50\t50", "# by hand\n50\t50", 1)
    check_values(read(tmp_path, "# made by X\n" + commented))
    timeless = "# made by X\n" + commented.replace("2\t0.02", "2\t", 1)
    with pytest.raises(FileFormatError, match=r"line 11.*no time"):
        read(tmp_path, timeless)


def test_utf_16(tmp_path):
    (tmp_path / "a.trc").write_bytes(text().encode("utf-16"))
    check_values(read_trc(tmp_path / "a.trc", CaptureOptions()))


def test_rows_cut_short_are_read_as_far_as_they_go_and_told(tmp_path):
    capture = read(tmp_path, text(rows=[ROWS[0], "2\t0.02\t101\t1501\t-51\t120", ROWS[2]]))
    check_values(capture)
    note = "1 row ends early, in line 8 (6 of 8 columns)"
    assert [one for one in capture.notes if one.startswith(note)]


def test_between_blanks_a_short_row_does_not_show_which_columns_it_lacks(tmp_path):
    rows = ["1 0.00 100 1500 -50 120 20 60", "2 0.02 120 20 60", "3 0.04 100 1500 -50 120 20 60"]
    capture = read(tmp_path, text(names="Frame# Time Head Toe", rows=rows))
    np.testing.assert_array_equal(capture.markers.present.all(axis=1), [True, False, True])
    np.testing.assert_array_equal(capture.markers.present.any(axis=1), [True, False, True])
    assert any("5 of 8 columns" in note and "all markers are missing" in note for note in capture.notes)


def test_units_come_from_the_header_or_the_caller(tmp_path):
    metres = text(TIDY.replace("mm", "m"), rows=["1\t0\t0.1\t1.5\t0\t0.1\t0.1\t0.1"] * 3)
    assert read(tmp_path, metres).markers.positions_m[0, 0, 2] == 1.5
    assert read(tmp_path, text(), unit="cm").markers.positions_m[0, 0, 2] == 15.0
    unstated = read(tmp_path, text("50\t50\t3\t2"))
    assert unstated.length_unit == "mm"
    assert any("no length unit" in note for note in unstated.notes)
    with pytest.raises(FileFormatError, match=r"'ells'.*--unit"):
        read(tmp_path, text(TIDY.replace("mm", "ells")))
    many = "\t".join(str(i * 0.2) for i in range(12))
    four = "Frame#\tTime\tA\t\t\tB\t\t\tC\t\t\tD\t\t"
    with pytest.raises(InvalidInput, match="--unit"):
        read(tmp_path, text("50\t50\t1\t4\tmm", four, [f"1\t0\t{many}"]))


def test_axes_follow_up(tmp_path):
    np.testing.assert_allclose(read(tmp_path, text(), up="z").markers.positions_m[0, 0], [0.1, 1.5, -0.05])
    with pytest.raises(UnknownName, match="axis 'up'"):
        read(tmp_path, text(), up="up")


def test_disagreements_are_remarked(tmp_path):
    notes = read(tmp_path, text("60\t60\t3\t2\tmm")).notes
    assert any("60 Hz" in note and "50 Hz" in note for note in notes)
    notes = read(tmp_path, text("50\t50\t2\t5\tmm")).notes
    assert any("counts 5 markers" in note for note in notes)
    assert any("counts 2 frames" in note for note in notes)
    still = [row.replace("0.02", "0.00").replace("0.04", "0.00") for row in ROWS]
    assert any("does not increase" in note for note in read(tmp_path, text(rows=still)).notes)


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        ("", "not a TRC"),
        ("time\tx\n1\t2\n", "line 1.*not a TRC"),
        (text(rows=[]), "cut short|no frames"),
        (text(rows=ROWS[:1]).rstrip(), "cut short: the header promises 3 frames, 1"),
        (text().rstrip()[:-10], "line 9.*cut short within a row"),
        (text("\t\t\tmm"), "line 3.*DataRate"),
        (text("0\t0\t3\t2\tmm"), "line 3.*DataRate"),
        (text(names="Frame#\tTime"), "line 4.*no marker"),
        (text(rows=[*ROWS[:2], "3\t0.04\tx\t1\t1\t1\t1\t1"]), "line 9.*not a number"),
        (text(rows=[ROWS[0] + "\t5\t5", *ROWS[1:]]), "10 columns; each point needs 3"),
        (text(rows=[*ROWS[:2], "3\t\t1\t1\t1\t1\t1\t1"]), "line 9.*no time"),
    ],
)
def test_broken_files_are_refused_with_the_line(tmp_path, content, reason):
    with pytest.raises(FileFormatError, match=reason):
        read(tmp_path, content)


@pytest.mark.parametrize("frames", [2, 300])
def test_a_wrong_count_of_frames_is_told_where_the_last_row_is_whole(tmp_path, frames):
    capture = read(tmp_path, text(TIDY.replace("\t3\t", f"\t{frames}\t", 1)))
    check_values(capture)
    assert f"the header counts {frames} frames, 3 are there" in capture.notes


def test_points_beyond_the_names_are_read_and_called_by_their_number(tmp_path):
    capture = read(tmp_path, text(rows=[row + "\t7\t8\t9\t\t\t" for row in ROWS]))
    assert capture.markers.names == ("Head", "L.Toe Tip", "*2")
    np.testing.assert_allclose(capture.markers.positions_m[:, 2], np.tile([0.007, -0.009, 0.008], (3, 1)))
    assert "1 points have columns and no name; called by their number: *2" in capture.notes


def test_a_point_without_a_name_between_named_ones_keeps_its_columns(tmp_path):
    names = "Frame#\tTime\tHead\t\t\t\t\t\tL.Toe Tip\t\t"
    rows = ["1\t0.00\t100\t1500\t-50\t7\t8\t9\t120\t20\t60"]
    capture = read(tmp_path, text(names=names, rows=rows))
    assert capture.markers.names == ("Head", "*1", "L.Toe Tip")
    np.testing.assert_allclose(capture.markers.positions_m[0, 2], [0.12, -0.06, 0.02])


def test_names_that_occur_twice_are_renamed_and_told(tmp_path):
    capture = read(tmp_path, text(names="Frame#\tTime\tHead\t\t\tHead\t\t"))
    assert capture.markers.names == ("Head", "Head_2")
    assert any("Head → Head_2" in note for note in capture.notes)


def test_axes_in_another_order_are_read_by_their_titles(tmp_path):
    mixed = text().replace("X1\tY1\tZ1\tX2\tY2\tZ2", "Z1\tX1\tY1\tZ2\tX2\tY2")
    capture = read(tmp_path, mixed)
    # file z, x, y = 100, 1500, −50, so x = 1500, y = −50, z = 100; world x, −z, y
    np.testing.assert_allclose(capture.markers.positions_m[0, 0], [1.5, -0.1, -0.05])
    assert any("ordered Z, X, Y" in note for note in capture.notes)


@quick
@given(order=st.permutations(range(4)))
def test_the_order_of_markers_does_not_matter(tmp_path, order):
    values = np.arange(24.0).reshape(2, 4, 3) / 10.0 + 0.1
    markers = MarkerTrajectories(tuple("ABCD"), values, 100.0)
    write_trc(markers.select(tuple("ABCD"[i] for i in order)), tmp_path / "a.trc")
    back = read_trc(tmp_path / "a.trc", CaptureOptions(unit="mm")).markers.select(markers.names)
    np.testing.assert_allclose(back.positions_m, values, atol=1e-9)


def rows_at(times):
    return [f"{k + 1}\t{t:.3f}\t{100 + k}\t1000\t5\t1\t2\t3" for k, t in enumerate(times)]


def lines_of(times, rate=240.0):
    head = f"{rate}\t{rate}\t{len(times)}\t2\tmm\t{rate}\t1\t{len(times)}"
    return text(header=head, rows=rows_at(times))


def test_missing_rows_are_gaps_where_the_time_column_says_so(tmp_path):
    """At 240 Hz with times of three decimals, whose steps are 4 or 5 ms."""
    kept = [k for k in range(60) if k not in {10, 11, 12, 40}]
    found = read(tmp_path, lines_of([k / 240.0 for k in kept]))
    seen = found.markers.present.any(axis=1)
    assert found.markers.frames == 60 and np.flatnonzero(seen).tolist() == kept
    assert any("rows of 4 frames are missing" in note for note in found.notes)
    assert not any("Hz" in note for note in found.notes)


@pytest.mark.parametrize("at", [5, 20, -1])
def test_a_time_that_cannot_be_is_refused_with_its_line(tmp_path, at):
    times = [k / 240.0 for k in range(40)]
    times[at] = 99.0
    with pytest.raises(FileFormatError, match=r"row \d+, the time (goes back|jumps by)"):
        read(tmp_path, lines_of(times))


def test_uneven_times_of_another_rate_stay_as_they_are(tmp_path):
    found = read(tmp_path, lines_of([k / 100.0 for k in range(40)]))
    assert found.markers.frames == 40 and any("the header is used" in note for note in found.notes)


def test_missing_file(tmp_path):
    with pytest.raises(FileFormatError, match="no such file"):
        read_trc(tmp_path / "none.trc", CaptureOptions())


@quick
@given(
    values=arrays(np.float64, (4, 3, 3), elements=st.floats(-5.0, 5.0)),
    hidden=arrays(np.bool_, (4, 3)),
    rate_hz=st.sampled_from([50.0, 59.94, 100.0, 119.88, 200.00000000000426]),
    start_s=st.floats(0.0, 1000.0),
)
def test_round_trip(tmp_path, values, hidden, rate_hz, start_s):
    missing = hidden | (np.abs(values) < 1e-6).all(axis=2)
    values = np.where(missing[:, :, None], np.nan, values)
    markers = MarkerTrajectories(("A", "R.Toe Tip", "*2"), values, rate_hz, start_s)
    write_trc(markers, tmp_path / "a.trc")
    back = read_trc(tmp_path / "a.trc", CaptureOptions(unit="mm")).markers
    assert (back.names, back.rate_hz) == (markers.names, rate_hz)
    assert back.start_time_s == pytest.approx(start_s, abs=1e-7)
    np.testing.assert_allclose(back.positions_m, values, atol=1e-9)


@pytest.mark.parametrize(
    ("name", "markers", "rate_hz", "frames", "start_s", "shifted"),
    [
        ("rajagopal_walk_run/motion_capture_walk.trc", 41, 100.0, 238, 0.0, True),
        ("rajagopal_walk_run/static_walk_2.trc", 41, 100.0, 153, 0.0, True),
        ("rajagopal_walk_run/static_walk_1.trc", 64, 100.0, 287, 0.0, False),
        ("rajagopal_walk_run/static_run.trc", 64, 100.0, 397, 0.0, False),
        ("rajagopal_walk_run/motion_capture_run.trc", 42, 100.0, 510, 0.23, False),
        ("gait2354_walk/subject01_walk1.trc", 41, 60.0, 151, 0.0, False),
        ("gait2354_walk/subject01_static.trc", 49, 60.0, 300, 0.0, False),
        ("synthetic_exact_truth/subject01_walk2_markers.trc", 64, 200.00000000000426, 223, 3.38, False),
    ],
)
def test_reference_captures(real_data, name, markers, rate_hz, frames, start_s, shifted):
    capture = read_trc(real_data / name, CaptureOptions())
    found = capture.markers
    assert (len(found.names), found.rate_hz, found.frames, found.start_time_s) == (
        markers,
        rate_hz,
        frames,
        start_s,
    )
    assert found.present.all()
    assert capture.length_unit == ("m" if "synthetic" in name else "mm")
    assert bool(capture.notes) == shifted
    assert 1.5 < np.nanmax(found.positions_m[:, :, 2]) < 1.9


def test_a_reference_capture_whose_header_counts_from_the_start_of_the_recording(real_data):
    """Frames 1163 to 1300 of a recording, which its header counts as 1300."""
    capture = read_trc(real_data / "biobuddy_functional" / "static.trc", CaptureOptions(up="z"))
    assert (capture.markers.frames, len(capture.markers.names)) == (138, 49)
    assert capture.notes == ("the header counts 1300 frames, 138 are there",)
