"""A session with electromyograms: one muscle of the right leg, one of the left, one without a side."""

from dataclasses import replace

import numpy as np

from mbkf.io.muscle_bursts import MuscleBurst
from tests.study.session.sessions import walks


def with_muscles(r, loud=1.0):
    """A trial with muscles: the right soleus grows with time, and is active from 1 s to 2 s."""
    ramp = loud * 1e-4 * np.stack([r.times_s, 2.0 * r.times_s, np.ones(r.frames)], axis=1)
    return replace(
        r,
        muscle_names=("soleus_r", "soleus_l", "emg_3"),
        emg_envelope=ramp,
        muscle_bursts=(MuscleBurst("soleus_r", 1.0, 2.0),),
        emg_rate_hz=1500.0,
    )


def mixed():
    """A walk with electromyograms, and one without."""
    one, other = walks()
    return [with_muscles(one), other]
