"""Figures of inertial measurements, drawn by matplotlib, which the extra ``figures`` brings."""

from mbkf.stream.libraries import library

library("matplotlib", "a figure of inertial measurements", "figures")
