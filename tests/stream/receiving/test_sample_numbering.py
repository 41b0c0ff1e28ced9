"""Numbers of plate samples rise whatever their source counts, and follow each other where a count jumps."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mbkf.stream.receiving.numbering import BACK_FRAMES
from mbkf.stream.receiving.sample_numbering import FIRST_S, SampleNumbering
from mbkf.stream.source import UNCOUNTED

RATE_HZ = 1000.0


def placed(chunks, first_s=0.0):
    """Numbers given to chunks that come every 10 ms, and the numbering."""
    numbering, found = SampleNumbering(RATE_HZ), []
    for k, chunk in enumerate(chunks):
        index = np.array(chunk, dtype=np.int64)
        numbers, kept = numbering.place(index, first_s + 0.01 * k, 10 * k + 9)
        assert len(numbers) == (len(index) if kept is None else kept.sum())
        found.append(numbers.tolist())
    return found, numbering


def tens(first, count):
    return [list(range(first + 10 * k, first + 10 * k + 10)) for k in range(count)]


def test_a_regular_count_is_kept():
    chunks = tens(0, 20)
    del chunks[5][3:6], chunks[9]
    found, numbering = placed(chunks)
    assert found == chunks
    assert (numbering.jumps, numbering.shift) == (0, 0)


@pytest.mark.parametrize("jump", [2000, 10**6, 2**35, -2000, -(2**35)])
def test_a_count_that_jumps_goes_on_where_it_ended(jump):
    chunks = tens(0, 10) + [[n + jump for n in chunk] for chunk in tens(100, 10)]
    found, numbering = placed(chunks)
    assert found == tens(0, 20)
    assert (numbering.jumps, numbering.shift) == (1, -jump)


def test_a_single_strange_count_takes_its_place():
    chunks = tens(0, 20)
    chunks[7][4] = 10**9
    found, _ = placed(chunks)
    assert found == tens(0, 20)


def test_counts_that_cannot_be_read_have_no_number():
    chunks = tens(0, 20)
    chunks[7][4], chunks[8][0] = UNCOUNTED, 2**60
    found, numbering = placed(chunks)
    assert found[7] == [70, 71, 72, 73, 75, 76, 77, 78, 79]
    assert found[8] == list(range(81, 90))
    assert numbering.jumps == 0


def test_repeated_and_swapped_samples_are_left_out():
    found, _ = placed([[0, 1, 1, 3, 2, 4], [3, 4, 5]])
    assert found == [[0, 1, 3, 4], [5]]


def test_a_count_set_a_little_back_is_noticed_after_a_few_chunks():
    found, numbering = placed(tens(0, 10) + tens(50, 10))
    assert found[10 : 10 + BACK_FRAMES - 1] == [[]] * (BACK_FRAMES - 1)
    assert numbering.jumps == 1
    assert found[-1][-1] == pytest.approx(199, abs=30)


def test_first_samples_far_from_their_frame_belong_to_its_end():
    far = int(FIRST_S * RATE_HZ) + 100
    found, numbering = placed(tens(far, 3))
    assert found == tens(0, 3)
    assert numbering.jumps == 1
    near, _ = placed(tens(5000, 3))
    assert near == tens(5000, 3)


def test_samples_do_not_run_ahead_of_their_frames():
    """Each chunk leaves out a little less than a second, which a single one might."""
    found, numbering = placed([range(900 * k, 900 * k + 10) for k in range(50)])
    assert numbering.jumps > 0
    assert found[-1][-1] <= 499 + 1000


def test_steps_that_are_none_do_not_either():
    """Time stamps that are smoothed after an hour's jump have nearly a second between two samples."""
    found, _ = placed([*tens(0, 10), *(list(range(9000 * k, 9000 * k + 9000, 900)) for k in range(1, 40))])
    assert found[-1][-1] <= 499 + 1000
    assert all(b > a for a, b in pairwise(n for chunk in found for n in chunk))


def test_after_an_outage_samples_go_on_at_their_frame():
    """Both counts begin anew three seconds later; the frames' own count says which sample belongs to which."""
    numbering = SampleNumbering(RATE_HZ)
    numbering.place(np.arange(10), 0.0, 9)
    numbers, _ = numbering.place(np.arange(6), 3.0, 3009, fitting=3005)
    assert numbers.tolist() == list(range(3005, 3011))
    again = SampleNumbering(RATE_HZ)
    again.place(np.arange(5000, 5010), 0.0, 5009)
    numbers, _ = again.place(np.arange(6), 3.0, 8009)
    assert numbers.tolist() == list(range(8004, 8010))


@given(
    st.lists(
        st.lists(
            st.one_of(st.integers(0, 60), st.integers(-(2**63), 2**63 - 1), st.integers(0, 5000)), max_size=12
        ),
        max_size=20,
    )
)
def test_numbers_always_rise(chunks):
    found, _ = placed(chunks)
    numbers = [n for chunk in found for n in chunk]
    assert all(b > a for a, b in pairwise(numbers))
