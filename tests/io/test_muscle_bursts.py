"""Bursts come back from a file as they were."""

from mbkf.io.muscle_bursts import MuscleBurst, bursts_of_text
from mbkf.io.quantities_h5 import plain_json


def test_bursts_survive_a_file():
    bursts = (MuscleBurst("soleus_r", 0.25, 0.5), MuscleBurst("emg_1", 1.0, 1.5))
    assert bursts_of_text(plain_json(bursts)) == bursts
