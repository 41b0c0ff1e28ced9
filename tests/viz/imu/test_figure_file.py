"""A figure's file is known as mbkf's own, whatever its kind."""

import pytest

pytest.importorskip("matplotlib", reason="needs the extra 'figures'")

from matplotlib.figure import Figure

from mbkf.io.files_read import own_files_read
from mbkf.io.written import form_of
from mbkf.viz.imu.figure_file import write_figure


@pytest.mark.parametrize("suffix", [".png", ".svg", ".pdf"])
def test_a_figure_is_known_and_replaced(suffix, tmp_path):
    path = tmp_path / f"figure{suffix}"
    for _ in range(2):
        with own_files_read():
            write_figure(Figure(), path, dpi=20)
    assert form_of(path) is not None
    Figure().savefig(path)
    assert form_of(path) is None
