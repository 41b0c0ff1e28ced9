"""QTM's parameters become a stream in metres and world axes; plates that cannot be read are left out by name."""

import numpy as np
import pytest

from mbkf.errors import MbkfError
from mbkf.stream.qualisys.parameters import read_parameters

PLATE = """<Plate><Plate_ID>{number}</Plate_ID><Frequency>{rate}</Frequency><Name>{name}</Name><Location>
<Corner1><X>600</X><Y>400</Y><Z>{z}</Z></Corner1><Corner2><X>0</X><Y>400</Y><Z>0</Z></Corner2>
<Corner3><X>0</X><Y>0</Y><Z>0</Z></Corner3><Corner4><X>600</X><Y>0</Y><Z>0</Z></Corner4></Location></Plate>"""


def xml(general="<Frequency>200</Frequency>", up="+Z", labels=("A", "B &amp; C"), force=""):
    names = "".join(f"<Label><Name>{one}</Name><RGBColor>1</RGBColor></Label>" for one in labels)
    return f"""<QTM_Parameters_Ver_1.25><General>{general}</General>
    <The_3D><AxisUpwards>{up}</AxisUpwards><Labels>{len(labels)}</Labels>{names}</The_3D>
    <Force><Unit_Length>mm</Unit_Length>{force}</Force></QTM_Parameters_Ver_1.25>"""


def plate(number=1, rate=1000, name="left", z=0):
    return PLATE.format(number=number, rate=rate, name=name, z=z)


def test_labels_rate_and_plates():
    found = read_parameters(xml(force=plate(3)))
    assert found.stream.marker_names == ("A", "B & C")
    assert (found.stream.rate_hz, found.stream.plate_rate_hz, found.plate_ids) == (200.0, 1000.0, (3,))
    (one,) = found.stream.plates
    np.testing.assert_allclose(one.corners_m, [[0.6, 0.4, 0], [0, 0.4, 0], [0, 0, 0], [0.6, 0, 0]])
    np.testing.assert_allclose(one.origin_m, [0.3, 0.2, 0])


def test_the_axis_that_points_up_is_qtms_or_the_one_given():
    turned = read_parameters(xml(up="+Y")).rotation
    np.testing.assert_array_equal(turned @ [0, 1, 0], [0, 0, 1])
    np.testing.assert_array_equal(read_parameters(xml(up="+Y"), "z").rotation, np.eye(3))


def test_plates_that_cannot_be_read_are_named():
    force = plate() + plate(2, name="flat").replace("400", "0") + plate(3, rate=500, name="slow")
    found = read_parameters(xml(force=force))
    assert found.plate_ids == (1,)
    assert [sentence.split("'")[1] for sentence in found.left_out] == ["flat", "slow"]


def test_older_versions_number_plates_by_index():
    force = plate(5).replace("Plate_ID", "Force_Plate_Index")
    assert read_parameters(xml(force=force)).plate_ids == (5,)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "frame rate"),
        ("<a>" * 5000, "frame rate"),
        (xml(general="<Frequency>0</Frequency>"), "'0'"),
        (xml(general="<Frequency>nan</Frequency>"), "'nan'"),
        (xml(up="north"), "north"),
    ],
)
def test_parameters_without_a_rate_or_with_a_wrong_axis_are_refused(text, words):
    with pytest.raises(MbkfError, match=words):
        read_parameters(text)
