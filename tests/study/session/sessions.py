"""Sessions of true walks, for tests of what is made of sessions: no filter runs."""

from dataclasses import replace
from functools import cache

import numpy as np

from mbkf.io.contacts import Source
from mbkf.study.session.gather import session_of
from tests.recordings import recorded

SECONDS = 3.5


@cache
def walks(count=2, first=5):
    """Walks of one person: the same motion with angles moved by 1° from trial to trial."""
    r = recorded("walk", SECONDS, first)
    return tuple(
        replace(
            r,
            trial=f"walk {k}",
            angles=r.angles + np.deg2rad(k),
            angle_rates=np.gradient(r.angles, r.times_s, axis=0),
        )
        for k in range(count)
    )


@cache
def session(count=2, first=5):
    """A session of these walks."""
    return session_of(walks(count, first), f"session {first}")


@cache
def person(count=2, first=5, age=30.0):
    """A session with the person's age and sex, which norms ask for."""
    return replace(session(count, first), sex="female", age=age)


def estimated(r, frames=slice(None)):
    """A trial whose loads were not measured but estimated in some frames."""
    measured, source = r.measured.copy(), r.foot_source.copy()
    measured[frames] = False
    source[frames] = np.where(source[frames] != Source.NONE, Source.ESTIMATED, Source.NONE)
    return replace(r, measured=measured, foot_source=source)
