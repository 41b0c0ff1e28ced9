"""The page: tables of trials beside references."""

from benchmarks.checks import Check
from benchmarks.real_truth.page import PAGE, write_page
from tests.benchmarks.real_truth.made import compared, series


def test_the_page_has_a_row_for_each_trial(tmp_path):
    moment = series("hip_flexion_r", 0.1, 0.05, group="moment", sd=0.2, varying_sd=0.1)
    walk = compared("HC032A", moments=(moment,), tilt=5.0, line=1.0, kind="Plug-in Gait")
    standing = compared("HC032A", "standing", hips=(2.0, 5.0), kind="Plug-in Gait")
    found = {"session": [standing, walk], "static": [standing, walk]}
    write_page(tmp_path, found, [Check("one: marker RMS over that before", 1.02, 1.15, "<=")])
    lines = (tmp_path / PAGE).read_text(encoding="utf-8").splitlines()
    assert "| HC032A | standing, walk | 1.5, 3.0 | 1.5, 3.0 |" in lines
    assert "| HC032A, standing (Plug-in Gait) | +2.0, +5.0 |  |  |" in lines
    assert "| HC032A, walk (Plug-in Gait) | +1.0, +2.0; 0.7, 0.99; 100, 100 % |  |  |" in lines
    assert "| HC032A, walk (Plug-in Gait) | +0.10; 0.04, 0.90; 100, 100 % |  |  |" in lines
    assert "| HC032A, walk | +1.0 | +4.0 | +4.0 |" in lines
    assert "| HC032A, walk | 50 | 40 | 40 |" in lines
    assert "| HC032A, walk, r | 8 | 14 | 14 |" in lines
    assert "| hip | 1.52 | 0.71 | 0.71 |" in lines
    assert "| one | 1.02 |  |  |  |  |" in lines
