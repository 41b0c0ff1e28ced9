"""Chains of frames fixed to a body of an OpenSim model."""

import numpy as np
import pytest

from mbkf.io.loose_xml import parse_loose_xml
from mbkf.io.osim_frames import body_frame, placed, vector


def frames(text):
    return {one.name: one for one in parse_loose_xml(text).every("PhysicalOffsetFrame")}


def test_frames_follow_each_other_to_their_body():
    outer = "<socket_parent>/bodyset/shin</socket_parent><translation>1 0 0</translation>"
    outer += "<orientation>0 0 1.5707963267948966</orientation>"
    inner = "<socket_parent>../outer</socket_parent><translation>0 2 0</translation>"
    known = frames(
        f'<PhysicalOffsetFrame name="outer">{outer}</PhysicalOffsetFrame>'
        f'<PhysicalOffsetFrame name="inner">{inner}</PhysicalOffsetFrame>'
    )
    body, pose = body_frame("/jointset/knee/inner", known)
    assert body == "shin"
    assert pose[:3, 3] == pytest.approx([-1.0, 0.0, 0.0])
    assert pose[:3, 0] == pytest.approx([0.0, 1.0, 0.0])


def test_frames_in_a_circle_end():
    text = '<PhysicalOffsetFrame name="a"><socket_parent>a</socket_parent></PhysicalOffsetFrame>'
    assert body_frame("a", frames(text))[0] == "a"


def test_turns_are_about_the_frame_s_own_axes_x_first():
    quarter = np.pi / 2.0
    assert placed("", f"{quarter} {quarter} 0")[:3, 2] == pytest.approx([1.0, 0.0, 0.0])
    assert placed("", f"{quarter} {quarter} 0")[:3, 0] == pytest.approx([0.0, 1.0, 0.0])


@pytest.mark.parametrize("text", ["", "1 2", "1 2 nan", "1 2 3 4", "a b c"])
def test_texts_that_are_no_vector(text):
    assert vector(text) is None
