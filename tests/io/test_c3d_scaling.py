"""Analog samples with a sign or without one are scaled to the same, as integers and as floats."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mbkf.io.c3d_decode import decode
from mbkf.io.c3d_layout import check_layout
from mbkf.io.c3d_scaling import TAKEN_AS_UNSIGNED, stored_samples
from mbkf.io.capture import read_capture
from mbkf.io.records import SampleScaling
from tests.io.c3d_builder import standing_points
from tests.io.c3d_bytes import INTEL, c3d_bytes, floats, integers

POINTS = standing_points(12, 5)
ANALOGS = np.round(np.random.default_rng(0).normal(0.0, 50.0, (12, 3, 2)))
UNSIGNED = ((2, "FORMAT", -1, (8,), b"UNSIGNED"),)


@pytest.mark.parametrize("stated", [True, False])
@pytest.mark.parametrize("scale", [None, 0.1])
@pytest.mark.parametrize("stored", ["unsigned", "signed"])
def test_an_offset_beyond_the_signed_range(tmp_path, scale, stated, stored):
    """Floats may have been converted with a sign (samples near −32768) or without one (near 32768)."""
    path = tmp_path / "x.c3d"
    offset = 32768 if stored == "unsigned" else -32768
    path.write_bytes(c3d_bytes(POINTS, ANALOGS, scale=scale, offset=offset, extra=UNSIGNED if stated else ()))
    found = decode(path, check_layout(path))
    np.testing.assert_allclose(found.analogs, ANALOGS.reshape(-1, 2).T, atol=1e-2)
    integers = scale is not None
    assert (TAKEN_AS_UNSIGNED in found.notes) is (not stated and (integers or stored == "unsigned"))


def test_offsets_inside_the_signed_range_keep_their_sign(tmp_path):
    path = tmp_path / "x.c3d"
    path.write_bytes(c3d_bytes(POINTS, ANALOGS, offset=-7))
    np.testing.assert_allclose(decode(path, check_layout(path)).analogs, ANALOGS.reshape(-1, 2).T, atol=1e-4)


@pytest.mark.parametrize("name", [b"OFFSET", b"SCALE", b"GEN_SCALE"])
def test_a_missing_scale_or_offset_is_reported(tmp_path, name):
    content = c3d_bytes(POINTS, ANALOGS)
    at = content.rindex(bytes([len(name), 2]) + name)  # its length and the group ANALOG stand before it
    path = tmp_path / "x.c3d"
    path.write_bytes(content[: at + 2] + b"Q" + content[at + 3 :])
    notes = decode(path, check_layout(path)).notes
    assert [note for note in notes if f"lacks ANALOG:{name.decode()}: " in note]


@pytest.mark.parametrize(("name", "default"), [("OFFSET", 0), ("SCALE", 1)])
def test_channels_beyond_a_short_list_are_reported(tmp_path, name, default):
    body = (2, (1,), integers([7], INTEL)) if name == "OFFSET" else (4, (1,), floats([2.0], INTEL))
    path = tmp_path / "x.c3d"
    path.write_bytes(c3d_bytes(POINTS, ANALOGS, extra=((2, name, *body),)))
    found = decode(path, check_layout(path))
    first, second = ANALOGS.reshape(-1, 2).T
    np.testing.assert_allclose(found.analogs[0], first - 7 if name == "OFFSET" else 2.0 * first, atol=1e-3)
    np.testing.assert_allclose(found.analogs[1], second, atol=1e-3)
    remark = f"ANALOG:{name} holds 1 of 2 channels; channels without are scaled with {default}"
    assert remark in found.notes


@pytest.mark.parametrize("name", ["signed_real", "unsigned16_real", "unsigned16_integer"])
def test_three_encodings_of_one_standing_load(real_data, name):
    plates = read_capture(real_data / "strangers3" / f"{name}.c3d").plates
    for plate in plates:
        np.testing.assert_allclose(plate.force_n[:, 2], 300.0, atol=0.1)


def test_a_standing_person_on_plates_of_unsigned_floats(real_data):
    plates = read_capture(real_data / "functional_walk" / "FunctionalStatic.c3d", tare=False).plates
    np.testing.assert_allclose([p.force_n[:, 2].mean() for p in plates], [287.0, 309.0, -11.0], atol=1.5)


COUNTS = st.integers(-(2**15), 2**15 - 1)


@given(
    st.one_of(
        st.tuples(st.lists(COUNTS, min_size=1), COUNTS),
        st.tuples(
            st.lists(st.floats(width=32, allow_nan=False, allow_infinity=False), min_size=1), st.just(0)
        ),
    ),
    st.floats(2.0**-20, 2.0**10, width=32),
    st.floats(2.0**-10, 2.0**10, width=32),
)
def test_samples_are_found_so_that_they_scale_to_the_values_again(stored, scale, general):
    """Counts of a converter beside any offset, and floats without one."""
    samples, offset = np.array(stored[0], dtype=float), float(stored[1])
    values = (samples - offset) * (scale * general)
    np.testing.assert_array_equal(stored_samples(values, SampleScaling(scale, general, offset)), samples)


def test_a_channel_without_a_scale_holds_zeros():
    np.testing.assert_array_equal(stored_samples(np.zeros(3), SampleScaling(0.0)), 0.0)
