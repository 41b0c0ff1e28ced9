"""`mbkf norms export` writes a table that `mbkf norms import` reads back number for number."""

import numpy as np

from mbkf.cli.main import main
from mbkf.io.norms import read_norms, write_norms
from mbkf.study.session.norms import norms_of
from tests.study.session.sessions import person


def test_the_table_comes_back(tmp_path):
    files = [str(tmp_path / name) for name in ("n.toml", "n.csv", "again.toml")]
    write_norms(norms_of([person(), person(1, 6)], "ours"), files[0])
    assert main(["norms", "export", files[0], "--out", files[1]]) == 0
    assert main(["norms", "import", files[1], "--out", files[2]]) == 0
    one, other = read_norms(files[0]), read_norms(files[2])
    assert one.curves.keys() == other.curves.keys() and one.measures.keys() == other.measures.keys()
    assert (one.read, one.name, one.ages) == (other.read, other.name, other.ages)
    for own, again in ((one.curves, other.curves), (one.measures, other.measures)):
        for key, band in own.items():
            np.testing.assert_array_equal([band.mean, band.sd], [again[key].mean, again[key].sd])
            assert (band.unit, band.persons) == (again[key].unit, again[key].persons)
