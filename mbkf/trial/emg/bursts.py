"""Times in which a muscle is active, by the double threshold of Bonato, D'Alessio and Knaflitz 1998.

Of white Gaussian noise with the variance s^2 the sum of the squares of two samples, over s^2, is chi-squared with two
degrees of freedom: it exceeds ζ with the probability p = exp(-ζ/2). Of m successive pairs, r or more exceed ζ with

    P = sum_{k >= r} (m over k) p^k (1 - p)^(m - k),

which is set; p and ζ follow. A burst begins with the first pair above ζ of the first such window and ends with the last
one. The samples are taken so far apart that the band's noise is nearly white.
"""

from __future__ import annotations

import numpy as np

from mbkf.conventions import Array
from mbkf.numerics.runs import runs
from mbkf.trial.emg.envelope import band_passed, upper_hz
from mbkf.trial.emg.settings import EmgSettings


def bursts(values: Array, rate_hz: float, settings: EmgSettings) -> Array:
    """(B, 2) begin and end of each burst in s after the first sample.

    Args:
        values: (S,) samples of the electromyogram.
        rate_hz: Sample rate.
        settings: Band and thresholds.
    """
    high_hz = upper_hz(rate_hz, settings)
    inside = band_passed(values, rate_hz, settings.burst_low_hz, high_hz, settings.burst_order)
    step = max(1, round(rate_hz / (2.0 * high_hz)))
    samples = inside[::step]
    pair_s = 2.0 * step / rate_hz
    noise = noise_variance(samples, max(2, round(settings.quiet_s * rate_hz / step)), settings.quiet_share)
    if noise <= 0.0:
        return np.empty((0, 2))
    energy = (samples[: 2 * (len(samples) // 2)].reshape(-1, 2) ** 2).sum(axis=1) / noise
    above = energy > threshold(settings)
    windows = np.convolve(above, np.ones(settings.pairs), "same") >= settings.needed
    found: list[list[int]] = []
    for first, end in runs(windows):
        loud = first + np.flatnonzero(above[first:end])
        if not len(loud):
            continue
        if found and (loud[0] - found[-1][1]) * pair_s < settings.shortest_s:
            found[-1][1] = int(loud[-1]) + 1
        else:
            found.append([int(loud[0]), int(loud[-1]) + 1])
    times_s = np.array(found, dtype=float).reshape(-1, 2) * pair_s
    return times_s[times_s[:, 1] - times_s[:, 0] >= settings.shortest_s]


def threshold(settings: EmgSettings) -> float:
    """ζ, over the variance of the noise, for the probability of a false alarm."""
    from scipy.optimize import brentq
    from scipy.special import bdtrc

    rest = settings.needed - 1
    p = brentq(lambda p: bdtrc(rest, settings.pairs, p) - settings.false_alarm, 0.0, 1.0, xtol=1e-15)
    return float(-2.0 * np.log(p))


def noise_variance(samples: Array, stretch: int, share: float) -> float:
    """Variance of the noise: that of the quietest stretches, over the ratio expected of white noise.

    The mean of n squares of noise has the quantile of chi-squared with n degrees of freedom, over n.

    Args:
        samples: (S,) samples of zero mean.
        stretch: Number of samples of a stretch.
        share: Share of the stretches that are quieter than the one taken.
    """
    from scipy.special import chdtri

    if len(samples) < stretch:
        return 0.0
    energy = np.convolve(samples**2, np.full(stretch, 1.0 / stretch), "valid")[:: max(1, stretch // 2)]
    return float(np.quantile(energy, share) * stretch / chdtri(stretch, 1.0 - share))
