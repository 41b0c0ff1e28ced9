"""The key numbers of a trial from its pieces: sums, largest values, quantiles (:mod:`mbkf.trial.results.summary`)."""

from __future__ import annotations

from collections import defaultdict
from typing import cast

import numpy as np

from mbkf.conventions import GRAVITY_M_S2, READING_KINDS, Array, BoolArray
from mbkf.io.dimensions import AXES
from mbkf.io.results import Reconstruction, SdPart
from mbkf.io.results_folder import Summary, TrunkTold
from mbkf.trial.results.innovations import BEFORE, SETTLING_S, before_correction
from mbkf.trial.results.summary import main_coordinates, marker_errors, quantile, summarise

PARTS: tuple[SdPart, ...] = ("total", "offset", "varying")
"""Parts of standard deviations that summaries state."""


class Tally:
    """Number, sum, sum of squares and largest of the finite values that it was given."""

    def __init__(self) -> None:
        """No value."""
        self.count, self.sum, self.squares, self._largest = 0, 0.0, 0.0, -np.inf

    def add(self, values: Array) -> None:
        """Adds values of any shape."""
        known = values[np.isfinite(values)]
        if known.size:
            self.count += known.size
            self.sum += float(known.sum())
            self.squares += float((known**2).sum())
            self._largest = max(self._largest, float(known.max()))

    @property
    def mean(self) -> float | None:
        """Their mean; None without a value."""
        return self.sum / self.count if self.count else None

    @property
    def rms(self) -> float | None:
        """Their root mean square; None without a value."""
        return float(np.sqrt(self.squares / self.count)) if self.count else None

    @property
    def largest(self) -> float | None:
        """The largest; None without a value."""
        return self._largest if self.count else None


class KeyNumbers:
    """Numbers of summary.json that add up over the pieces of a trial."""

    def __init__(self) -> None:
        """No piece."""
        self._tallies: dict[tuple[str, ...], Tally] = defaultdict(Tally)
        self._step_seconds: list[Array] = []
        self._kinds = np.zeros((2, len(READING_KINDS)))
        self._begin_s = 0.0
        self.frames = self.valid = self.measured = 0

    def add(self, r: Reconstruction) -> None:
        """Adds the next piece.

        Args:
            r: Its result, without margins.
        """
        if not self.frames:
            self._begin_s = float(r.times_s[0])
        self.frames += r.frames
        self.valid += int(r.valid.sum())
        self.measured += int(r.measured.sum())
        self._step_seconds.append(r.step_seconds)
        self._add_markers(r)
        self._add_loads(r)
        self._add_innovations(r)

    def settled(self, r: Reconstruction) -> BoolArray:
        """(T,) frames of a piece in which innovations count, once the filter has settled."""
        return np.asarray(r.times_s >= self._begin_s + SETTLING_S)

    def summary(self, r: Reconstruction) -> Summary:
        """The contents of summary.json.

        Args:
            r: The last piece, with the findings on the whole trial.
        """
        tally, weight_n = self._tallies, GRAVITY_M_S2 * float(r.subject.mass_kg)
        step_s = np.concatenate(self._step_seconds)
        computing, lasts_s = float(np.nansum(step_s)), self.frames / float(r.rate_hz)
        force_n, moment_nm = tally["residual", "force"].rms, tally["residual", "moment"].rms
        joints, levels = main_coordinates(r), r.level_names
        peaks = {joint: tally["moment", joint].largest for joint in joints}
        own = {
            "frames": self.frames,
            "duration_s": lasts_s,
            "missing_fraction": tally["missing",].mean,
            "marker_rms_mm": tally["seen",].rms,
            "marker_max_mm": tally["seen",].largest,
            "marker_rms_mm_by_name": {name: tally["seen", name].rms for name in r.marker_names},
            "hidden_marker_rms_mm": tally["hidden",].rms,
            "hidden_marker_max_mm": tally["hidden",].largest,
            "residual_force_rms_n": force_n,
            "residual_moment_rms_nm": moment_nm,
            "residual_force_share": None if force_n is None else force_n / weight_n,
            "residual_lever_m": None if moment_nm is None else moment_nm / weight_n,
            "valid_frames": self.valid,
            "measured_frames": self.measured,
            "plate_force_change_rms_n": tally["change", "force"].rms,
            "plate_moment_change_rms_nm": tally["change", "moment"].rms,
            "torque_peak_nm_per_kg": {
                joint: None if peak is None else peak / r.subject.mass_kg for joint, peak in peaks.items()
            },
            **{
                key: {joint: tally[part, joint].mean for joint in joints}
                for key, part in zip(
                    ("torque_sd_nm", "torque_sd_offset_nm", "torque_sd_varying_nm"), PARTS, strict=True
                )
            },
            "trunk_moments": {level: self._trunk(level) for level in levels},
            "nis_per_dof": tally["nis",].mean,
            "nis": self._by_kind(r),
            "marker_noise_mm_by_name": {} if r.marker_spread_m is None else self._noise(r.marker_names),
            "step_seconds_median": quantile(step_s, 50),
            "step_seconds_p99": quantile(step_s, 99),
            "realtime_factor": lasts_s / computing if computing > 0 else None,
        }
        return cast(Summary, {**summarise(r), **own})

    def _add_markers(self, r: Reconstruction) -> None:
        tally = self._tallies
        tally["missing",].add((~r.present).astype(float))
        seen_mm, hidden_mm = marker_errors(r)
        tally["seen",].add(seen_mm)
        tally["hidden",].add(hidden_mm)
        for m, name in enumerate(r.marker_names):
            tally["seen", name].add(seen_mm[:, m])

    def _add_loads(self, r: Reconstruction) -> None:
        tally, per_kg = self._tallies, 1.0 / float(r.subject.mass_kg)
        tally["residual", "force"].add(np.linalg.norm(r.residual_force_n[r.measured], axis=-1))
        tally["residual", "moment"].add(np.linalg.norm(r.residual_moment_nm[r.measured], axis=-1))
        if r.plate_change is not None:
            tally["change", "force"].add(r.plate_change[..., :3])
            tally["change", "moment"].add(r.plate_change[..., 3:])
        for joint, name in main_coordinates(r).items():
            tally["moment", joint].add(np.abs(r.moment(name)[r.tracked]))
            for part in PARTS:
                tally[part, joint].add(r.moment_sd(name, part)[r.tracked])
        ways = AXES["way"].labels
        for level in r.level_names:
            moments = [r.trunk_moment(level, way=way)[r.tracked] * per_kg for way in ways]
            for way, moment in zip(ways, moments, strict=True):
                tally["trunk", level, way].add(np.abs(moment))
                tally["trunk sd", level, way].add(r.trunk_moment_sd(level, way=way)[r.tracked])
            tally["trunk", level, "difference"].add(moments[0] - moments[1])

    def _add_innovations(self, r: Reconstruction) -> None:
        settled = self.settled(r)
        counted = settled & (r.nis_readings > 0)
        self._tallies["nis",].add(r.nis[counted] / r.nis_readings[counted])
        if r.nis_by_kind is not None and r.nis_readings_by_kind is not None:
            known = settled & np.isfinite(r.nis_by_kind).all(axis=1)
            self._kinds += [x[known].sum(axis=0) for x in (r.nis_by_kind, r.nis_readings_by_kind)]
        if r.marker_spread_m is not None:
            seen = np.where(settled[:, None] & r.present, r.marker_spread_m, np.nan)
            for m, name in enumerate(r.marker_names):
                self._tallies["noise", name].add(seen[:, m])

    def _by_kind(self, r: Reconstruction) -> dict[str, float]:
        squared, readings = self._kinds
        found = {kind: float(squared[k] / readings[k]) for k, kind in enumerate(READING_KINDS) if readings[k]}
        before = before_correction(r.checks)
        return found if before is None else found | {BEFORE: before}

    def _noise(self, names: tuple[str, ...]) -> dict[str, float | None]:
        rms = {name: self._tallies["noise", name].rms for name in names}
        return {name: None if one is None else 1e3 * one for name, one in rms.items()}

    def _trunk(self, level: str) -> TrunkTold:
        tally, (down, up) = self._tallies, AXES["way"].labels
        return {
            "peak_nm_per_kg": tally["trunk", level, down].largest,
            "sd_nm": tally["trunk sd", level, down].mean,
            "bottom_up_peak_nm_per_kg": tally["trunk", level, up].largest,
            "bottom_up_sd_nm": tally["trunk sd", level, up].mean,
            "difference_rms_nm_per_kg": tally["trunk", level, "difference"].rms,
        }
