"""The table of norms names its source and convention, and holds every number to the digits of norms.toml."""

import numpy as np

from mbkf.io.norm_files.read import read_foreign_norms
from mbkf.io.norm_files.written import write_norms_table
from mbkf.io.norms import Band, Norms


def test_numbers_and_statements_are_read_back(tmp_path):
    rng = np.random.default_rng(2)
    band = Band("deg", 7, 30.0 * rng.standard_normal(101), rng.uniform(1.0, 2.0, 101))
    key = ("walk", "angle", "knee_angle")
    norms = Norms(
        "ours", {key: band}, {("walk", "Speed"): Band("m/s", 7, np.array([1.25]), np.array([0.1]))},
        {(1.0, 1.2): {key: band}}, source="Rossi 2019", convention="clinical", axes="pig", ages=(20.0, 41.5),
    )  # fmt: skip
    write_norms_table(norms, tmp_path / "n.csv")
    found = read_foreign_norms(tmp_path / "n.csv")
    assert found.statements == {
        "name": "ours", "source": "Rossi 2019", "convention": "clinical", "axes": "pig", "persons": "7",
        "age": "20-41.5", "names": "mbkf",
    }  # fmt: skip
    assert [(b.quantity, b.label, b.unit, b.persons, b.speeds) for b in found.bands] == [
        ("angle", "knee_angle", "deg", 7, None),
        ("angle", "knee_angle", "deg", 7, (1.0, 1.2)),
        ("measure", "Speed", "m/s", 7, None),
    ]
    expected = [float(f"{one:.6g}") for one in band.mean]
    np.testing.assert_array_equal(found.bands[0].mean, expected)
