"""Without a maker's description nothing is stated."""

from mbkf.io.imu.table_defaults import NO_DEFAULTS


def test_the_empty_statements():
    assert (NO_DEFAULTS.units, NO_DEFAULTS.kind, NO_DEFAULTS.sensor, NO_DEFAULTS.frame) == ({}, "", "", "")
