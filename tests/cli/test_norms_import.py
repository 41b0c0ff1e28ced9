"""`mbkf norms import` writes bands, lists what it left out, and refuses norms without their convention."""

import pytest

from mbkf.cli.main import main
from mbkf.io.norms import read_norms
from tests.io.norm_files.made import long_table, pycgm2_text, wide_table


def test_a_table_with_its_statements(tmp_path, capsys):
    (tmp_path / "n.csv").write_text(wide_table("Knee extension (deg)"))
    assert main(["norms", "import", str(tmp_path / "n.csv"), "--out", str(tmp_path / "n.toml")]) == 0
    printed = capsys.readouterr().out
    assert "sign turned to the convention clinical: Knee extension" in printed
    assert "2 curves from a table, source: Rossi 2019" in printed
    norms = read_norms(tmp_path / "n.toml")
    assert (norms.source, norms.ages, norms.speeds) == ("Rossi 2019", (20.0, 40.0), (1.1, 1.4))


def test_a_data_set_with_its_statements_in_the_call(tmp_path, capsys):
    (tmp_path / "n.json").write_text(pycgm2_text())
    call = "--convention clinical --source S --persons 9 --age 20-40 --speed 1.1-1.4 --group Free --group Slow=0.7-1"
    assert (
        main(["norms", "import", str(tmp_path / "n.json"), *call.split(), "--out", str(tmp_path / "n.toml")])
        == 0
    )
    assert "left out: WristAngles X: no curve of mbkf has this name" in capsys.readouterr().out
    assert list(read_norms(tmp_path / "n.toml").by_speed) == [(0.7, 1.0)]


@pytest.mark.parametrize(
    ("text", "words", "message"),
    [
        (
            long_table().replace("# convention: clinical\n", ""),
            [],
            "'# convention: clinical' (or isb, model)",
        ),
        (long_table(), ["--age", "old"], "'old' is no range"),
        (long_table(), ["--group", "Free"], "no group 'Free'"),
    ],
)
def test_bad_input_is_one_line(tmp_path, text, words, message, refused):
    (tmp_path / "n.csv").write_text(text)
    refused(["norms", "import", str(tmp_path / "n.csv"), *words, "--out", str(tmp_path / "n.toml")], message)
