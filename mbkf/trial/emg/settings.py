"""Settings of the electromyograms: band, envelope, detection of bursts."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class EmgSettings:
    """Settings of the electromyograms.

    Band and rate follow SENIAM (H. J. Hermens et al., J. Electromyogr. Kinesiol. 10 (2000) 361-374) and ISEK (R.
    Merletti, Standards for reporting EMG data, J. Electromyogr. Kinesiol. 9 (1999) III-IV). The detection of bursts is
    that of P. Bonato, T. D'Alessio and M. Knaflitz (IEEE Trans. Biomed. Eng. 45 (1998) 287-299).

    Attributes:
        low_hz, high_hz: Band of the signal; the upper end at most 0.45 of the sample rate.
        order: Order of the Butterworth band-pass, run forwards and backwards.
        envelope_hz: Corner of the envelope's low-pass.
        envelope_order: Order of that Butterworth filter, run forwards and backwards.
        least_rate_hz: Channels with a lower sample rate hold no electromyogram that could be filtered; left out.
        burst_low_hz: Lower end of the band in which bursts are looked for: a higher one rings for a shorter time.
        burst_order: Order of that band-pass.
        pairs: Number of successive pairs of samples that are judged together.
        needed: Number of these that exceed the threshold in a burst.
        false_alarm: Probability that noise alone gives as many.
        shortest_s: Bursts and pauses below this are none.
        quiet_s, quiet_share: The noise is that of the quietest stretches: length, and the share of all stretches.
    """

    low_hz: float = 20.0
    high_hz: float = 450.0
    order: int = 4
    envelope_hz: float = 6.0
    envelope_order: int = 2
    least_rate_hz: float = 500.0
    burst_low_hz: float = 40.0
    burst_order: int = 2
    pairs: int = 5
    needed: int = 3
    false_alarm: float = 1e-4
    shortest_s: float = 0.03
    quiet_s: float = 0.1
    quiet_share: float = 0.1
