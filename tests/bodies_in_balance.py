"""A mass point that moves up and down on two feet, with exact forces: positions and contacts of a load balance."""

from dataclasses import replace

import numpy as np

from mbkf.conventions import GRAVITY_M_S2
from mbkf.trial.loads.balance import LoadBalance

RATE_HZ, MASS_KG = 100.0, 70.0
WEIGHT_N = MASS_KG * GRAVITY_M_S2
UP = np.array([0.0, 0.0, 1.0])


def moving(seconds=5.0, hz=1.3, height_m=0.04):
    """The balance of a body that bounces, sways and stands on both feet in turn."""
    t = np.arange(round(seconds * RATE_HZ)) / RATE_HZ
    turn = 2.0 * np.pi * hz
    centre = np.column_stack([0.02 * np.sin(turn * t), 0.0 * t, 1.0 + height_m * np.cos(turn * t)])
    fast = -(turn**2) * (centre - [0.0, 0.0, 1.0])
    force = MASS_KG * (fast + GRAVITY_M_S2 * UP)
    right = (0.5 + 0.5 * np.sign(np.sin(turn * t / 4.0)))[:, None] * force
    feet = np.stack([right, force - right], axis=1)
    return LoadBalance(RATE_HZ, MASS_KG, centre, feet, np.zeros_like(force), np.ones(len(t), dtype=bool))


def times_of(balance):
    """(T,) times of the frames."""
    return np.arange(len(balance.judged)) / RATE_HZ


def unloaded(balance, force_n, first_s=0.0, last_s=np.inf):
    """The balance where a force (3,) acts on the body from one time to another: feet give that much less."""
    t = times_of(balance)
    acts = ((t >= first_s) & (t <= last_s))[:, None]
    share = balance.feet_n[..., 2] / balance.feet_n[..., 2].sum(axis=1, keepdims=True)
    return replace(balance, feet_n=balance.feet_n - share[..., None] * (acts * force_n)[:, None])


def lagging(balance, frames):
    """The balance with positions that are so many frames late, as those of a causal filter in quick motion."""
    late = np.concatenate([balance.centre_m[:1].repeat(frames, axis=0), balance.centre_m])[
        : len(balance.judged)
    ]
    return replace(balance, centre_m=late)
