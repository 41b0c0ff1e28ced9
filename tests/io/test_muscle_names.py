"""Side and muscle of channels' labels, as laboratories write them."""

import pytest

from mbkf.io.muscle_names import Muscle, muscle_of, muscles
from mbkf.viz.language import words


@pytest.mark.parametrize(
    ("label", "name", "side"),
    [
        ("R_tibialis_anterior", "tibialis_anterior", "r"),
        ("Right Biceps femoris caput longu", "biceps_femoris", "r"),
        ("Voltage.LGAS", "gastrocnemius", "l"),
        ("Noraxon Desktop DTS.RT TIB.ANT.", "tibialis_anterior", "r"),
        ("R TA: EMG 1", "tibialis_anterior", "r"),
        ("LT MED. GASTRO", "gastrocnemius_medialis", "l"),
        ("r_gaslat_emg", "gastrocnemius_lateralis", "r"),
        ("EMGRightTA", "tibialis_anterior", "r"),
        ("TAR", "tibialis_anterior", "r"),
        ("RRF", "rectus_femoris", "r"),
        ("RF", "rectus_femoris", ""),
        ("L GMED", "gluteus_medius", "l"),
        ("LGM", "gm", "l"),
        ("EMG12", "emg_12", ""),
        ("Trigno Avanti Sensor 3: EMG.3", "emg_3", ""),
    ],
)
def test_muscle_and_side(label, name, side):
    assert muscle_of(label) == Muscle(name, side)


@pytest.mark.parametrize(
    "label",
    [
        *("Fx1", "Force.Mz2", "PF1Fx", "F1X", "Px1", "Channel_01", "LeftFootSwitch", "Voltage.15", "L Spare"),
        *("R_TA.ACC.X", "Sensor 1.GYRO.Y1", "EMG 1: ACC.X", "Bertec_treadmill_speed", "sync", ""),
    ],
)
def test_other_channels_are_no_muscles(label):
    assert muscle_of(label) is None


@pytest.mark.parametrize("language", ["en", "es"])
def test_every_muscle_has_a_name_in_each_language(language):
    assert set(words(language, "muscles")) == set(muscles())
