"""motion.h5: what is written is read back, with units; anything else is refused with one clear line."""

import dataclasses
import errno
import resource

import h5py
import numpy as np
import pytest

from mbkf.errors import FileFormatError
from mbkf.io.body_covariance import BodyCovariance
from mbkf.io.findings import Finding, not_judged
from mbkf.io.inertia import SegmentInertia
from mbkf.io.limb_doubts import LimbDoubt
from mbkf.io.results import ARRAYS, QUANTITIES, Reconstruction
from mbkf.io.results_h5 import ResultPieces, read_h5, write_h5
from mbkf.io.unexplained import UnexplainedLoad
from tests.io.reconstructions import made_up, made_up_whole
from tests.sealed import unsealed


@pytest.mark.parametrize("frames", [0, 1, 40])
def test_a_round_trip_keeps_everything_but_the_covariance(tmp_path, frames):
    known = BodyCovariance(("head",), ("A", "ü"), np.tril(np.random.default_rng(2).normal(size=(7, 7))))
    r = made_up_whole(
        frames,
        subject=dataclasses.replace(made_up().subject, covariance=known),
        file_axes="x,z,y",
        file_axes_source="body",
        markers_ignored={"X ü": "not known"},
        markers_explained=0.9,
        names_exchanged=(("RTOE", "RMT5", 43),),
        checks=(
            Finding("mass", 30.4, 1.0, "%", 5.0, "outside", "weigh ü", 70.0),
            not_judged("x", "mm", 1.0, "y"),
        ),
        unexplained=(UnexplainedLoad(0.1, 0.4, (1.0, -2.0, 590.0), 8.0, 0.82, "mass", "weigh ü"),),
        limb_doubts=(
            LimbDoubt(
                "left_thigh", "names exchanged", 0.1, 0.4, "left_thigh", 0.5, 0.03, 0.005, True, (("A", "ü"),)
            ),
            LimbDoubt("right_thigh", "fits badly", 0.1, 0.4),
        ),
    )
    write_h5(r, tmp_path / "motion.h5")
    back = read_h5(tmp_path / "motion.h5")
    assert back.covariance is None
    for f in dataclasses.fields(Reconstruction):
        one, other = getattr(r, f.name), getattr(back, f.name)
        if f.name in ("covariance", "subject"):
            continue
        if isinstance(one, np.ndarray):
            np.testing.assert_array_equal(one, other, strict=True)
        else:
            assert one == other, f.name
    mine, theirs = dataclasses.asdict(r.subject), dataclasses.asdict(back.subject)
    np.testing.assert_equal(theirs, mine)


def test_what_a_filter_does_not_estimate_is_not_written_and_comes_back_as_none(tmp_path):
    write_h5(made_up(), tmp_path / "motion.h5")
    back = read_h5(tmp_path / "motion.h5")
    with h5py.File(tmp_path / "motion.h5") as file:
        for name in ("plate_change", "foot_wrench_sd", "covariance", "plate_corners_m"):
            assert name not in file
            assert getattr(back, name) is None
        assert "footing" not in file
        assert back.foot_contact is None


def test_in_older_files_feet_alone_bear_and_what_is_measured_is_valid(tmp_path):
    r = made_up_whole(valid=np.arange(12) > 3, foot_contact=np.tile([-1, 2], (12, 1)))
    for path in ("dynamic.h5", "kinematic.h5"):
        write_h5(r, tmp_path / path)
        with unsealed(tmp_path / path) as file:
            for name in ("measured", "foot_source", *(key for key in file if key.startswith("support_"))):
                del file[name]
    back = read_h5(tmp_path / "dynamic.h5")
    np.testing.assert_array_equal(back.measured, r.valid)
    assert (back.foot_source == [3, 2]).all()
    assert back.support_names == () and back.support_wrench.shape == (12, 0, 6)
    assert {(one.part, one.how) for one in back.contacts} == {
        ("right_foot", "estimated"),
        ("left_foot", "shared"),
    }
    with unsealed(tmp_path / "kinematic.h5") as file:
        del file["footing"]
    assert (read_h5(tmp_path / "kinematic.h5").foot_source == 1).all()


def test_older_files_say_which_later_frames_they_know_by_the_rest(tmp_path):
    write_h5(made_up(smoothed=True), tmp_path / "motion.h5")
    with unsealed(tmp_path / "motion.h5") as file:
        assert file.attrs["later_frames"] == "smoothed (all later frames known)"
        del file.attrs["later_frames"]
    assert read_h5(tmp_path / "motion.h5").later_frames == "smoothed (all later frames known)"


def test_how_many_frames_later_ones_left_alone_is_kept(tmp_path):
    write_h5(made_up(smoothed=True, uncorrected=3), tmp_path / "motion.h5")
    assert read_h5(tmp_path / "motion.h5").uncorrected == 3
    with unsealed(tmp_path / "motion.h5") as file:
        del file.attrs["uncorrected"]
    assert read_h5(tmp_path / "motion.h5").uncorrected == 0


def test_in_older_files_spreads_have_no_offset_and_the_body_no_covariance(tmp_path):
    offsets = {name: one.beside for name, one in QUANTITIES.items() if one.offset_of or one.change_of}
    assert len(offsets) == 8 + 4
    write_h5(made_up_whole(sd_tau_offset=np.ones((12, 6))), tmp_path / "motion.h5")
    with unsealed(tmp_path / "motion.h5") as file:
        for name in offsets:
            del file[name]
    back = read_h5(tmp_path / "motion.h5")
    assert back.subject.covariance is None
    for name, total in offsets.items():
        np.testing.assert_array_equal(getattr(back, name), np.zeros_like(getattr(back, total)))


def test_older_files_have_no_axes(tmp_path):
    write_h5(made_up(file_axes="x,z,y"), tmp_path / "motion.h5")
    with unsealed(tmp_path / "motion.h5") as file:
        del file.attrs["file_axes"], file.attrs["file_axes_source"]
    back = read_h5(tmp_path / "motion.h5")
    assert (back.file_axes, back.file_axes_source) == ("x,y,z", "")


def test_older_files_tell_no_ignored_markers(tmp_path):
    write_h5(made_up(markers_ignored={"X": "not known"}, markers_explained=0.5), tmp_path / "motion.h5")
    with unsealed(tmp_path / "motion.h5") as file:
        del file.attrs["markers_ignored"], file.attrs["markers_explained"], file.attrs["names_exchanged"]
        del file.attrs["checks"]
    back = read_h5(tmp_path / "motion.h5")
    assert (back.markers_ignored, back.markers_explained, back.names_exchanged) == ({}, 1.0, ())
    assert back.checks == ()


def test_a_file_without_a_direction_is_told_in_the_laboratory(tmp_path):
    """Files of earlier versions."""
    write_h5(made_up(direction="heading", angles_read="pig", angles_zero="static"), tmp_path / "motion.h5")
    back = read_h5(tmp_path / "motion.h5")
    assert (back.angles_read, back.angles_zero) == ("pig", "static")
    with unsealed(tmp_path / "motion.h5") as file:
        del file.attrs["direction"], file.attrs["angles_read"], file.attrs["angles_zero"]
    back = read_h5(tmp_path / "motion.h5")
    assert (back.direction, back.angles_read, back.angles_zero) == ("laboratory", "model", "axes")


def test_every_quantity_carries_its_unit(tmp_path):
    write_h5(made_up_whole(), tmp_path / "motion.h5")
    with h5py.File(tmp_path / "motion.h5") as file:
        assert set(ARRAYS) - set(file) == {"covariance", "foot_contact"}  # the latter as "footing"
        for name in ARRAYS:
            if name in file:
                assert file[name].attrs["unit"] == file[name].attrs["units"] == QUANTITIES[name].unit.text


def test_settings_of_numpy_and_paths_are_plain_data(tmp_path):
    settings = {"gain": np.float64(2.0), "names": {"b", "a"}, "folder": tmp_path, "grid": np.arange(3)}
    write_h5(made_up(settings=settings), tmp_path / "motion.h5")
    back = read_h5(tmp_path / "motion.h5").settings
    assert back == {"gain": 2.0, "names": ["a", "b"], "folder": str(tmp_path), "grid": [0, 1, 2]}


def test_other_files_are_refused(tmp_path):
    with pytest.raises(FileFormatError, match="no such file"):
        read_h5(tmp_path / "none.h5")
    (tmp_path / "text.h5").write_text("hello")
    with pytest.raises(FileFormatError, match="damaged"):
        read_h5(tmp_path / "text.h5")
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["x"] = 1
    with pytest.raises(FileFormatError, match="not a reconstruction"):
        read_h5(tmp_path / "other.h5")


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (lambda file: file.__delitem__("q"), "damaged"),
        (lambda file: file.attrs.__setitem__("format_version", 99), "newer"),
        (
            lambda file: (file.__delitem__("q"), file.create_dataset("q", data=np.zeros((2, 7)))),
            "q must have",
        ),
        (lambda file: file.attrs.__setitem__("subject", "{}"), "damaged"),
    ],
)
def test_damaged_files_are_refused(tmp_path, damage, message):
    path = tmp_path / "motion.h5"
    write_h5(made_up(), path)
    with unsealed(path) as file:
        damage(file)
    with pytest.raises(FileFormatError, match=message):
        read_h5(path)


def test_keys_are_those_of_older_files(tmp_path):
    r = made_up_whole()
    write_h5(r, tmp_path / "motion.h5")
    with h5py.File(tmp_path / "motion.h5") as file:
        assert tuple(file["held_dofs"].asstr()) == r.unobserved_dofs == ("pelvis_5",)
        np.testing.assert_array_equal(file["footing"], r.foot_contact)
    back = read_h5(tmp_path / "motion.h5")
    assert back.unobserved_dofs == r.unobserved_dofs
    np.testing.assert_array_equal(back.foot_contact, r.foot_contact)


def test_the_inertia_of_a_persons_segments_comes_back(tmp_path):
    own = SegmentInertia(1.2, np.array([0.01, 0.0, -0.02]), 0.1, np.array([0.003, 0.003, 0.004]))
    made = made_up()
    write_h5(
        dataclasses.replace(made, subject=dataclasses.replace(made.subject, inertia={"pelvis": own})),
        tmp_path / "motion.h5",
    )
    found = read_h5(tmp_path / "motion.h5").subject.inertia["pelvis"]
    assert (found.mass_factor, found.mass_factor_sd) == (1.2, 0.1)
    np.testing.assert_array_equal(found.centre_shift_m, own.centre_shift_m)
    np.testing.assert_array_equal(found.centre_shift_sd_m, own.centre_shift_sd_m)


def test_a_file_too_large_for_the_system_is_its_error_and_closes(tmp_path):
    r = made_up_whole(400)
    written = ResultPieces(tmp_path / "motion.h5", 800)
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, limits[1]))
    try:
        with pytest.raises(OSError, match="motion") as refused:
            written.add(r)
        written.close()
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert refused.value.errno == errno.EFBIG and refused.value.filename == str(tmp_path / "motion.h5")
