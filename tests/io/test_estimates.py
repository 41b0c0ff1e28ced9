"""Quantities of filters: codes are those of the contact decision, and a result holds what a track shares with it."""

import numpy as np

from mbkf.filters.record import FIELDS, Track
from mbkf.io.estimates import CONTACT_CODES, Estimates, TrackEstimates
from mbkf.io.quantities import quantities
from mbkf.io.results import PLOTTED, QUANTITIES
from mbkf.io.results_h5 import read_h5, write_h5
from mbkf.io.results_opensim import opensim_table
from mbkf.sensors.contact.records import Contact
from tests.io.reconstructions import made_up
from tests.sealed import unsealed


def test_codes_of_contact_are_those_of_the_decision():
    words = {Contact.MEASURED: "own_plate", Contact.SHARED: "shared_plate"}
    assert {one.value: words.get(one, one.name.lower()) for one in Contact} == CONTACT_CODES


def test_a_track_and_a_result_share_the_declarations():
    shared = quantities(Estimates)
    assert len(shared) > 15
    for kind in (quantities(Track), quantities(TrackEstimates), QUANTITIES):
        assert {name: kind[name] for name in shared} == dict(shared)


def test_the_frame_record_holds_every_quantity_of_a_track():
    fields = {field.name: field.axes for field in FIELDS}
    for one in quantities(Track).values():
        assert one.axes[0] == "time"
        if one.written:
            assert fields[one.key] == one.axes[1:]


def test_the_height_of_feet_goes_wherever_a_result_goes(tmp_path):
    sd = np.random.default_rng(3).uniform(0.001, 0.02, (12, 2))
    r = made_up(foot_height_sd=sd)
    write_h5(r, tmp_path / "motion.h5")
    np.testing.assert_array_equal(read_h5(tmp_path / "motion.h5").foot_height_sd, sd)
    with unsealed(tmp_path / "motion.h5") as file:
        assert [axis[0].name for axis in file["foot_height_sd"].dims] == ["/times_s", "/foot"]
        assert file["foot_height_sd"].attrs["units"] == "m"
        del file["foot_height_sd"]
    older = read_h5(tmp_path / "motion.h5")
    assert older.foot_height_sd.shape == (12, 2) and np.isnan(older.foot_height_sd).all()
    table = opensim_table(r, "reactions.mot")
    np.testing.assert_array_equal(table.column("ground_height_l_sd"), sd[:, 1])
    assert "ground_height_l_sd" not in opensim_table(older, "reactions.mot").names
    assert PLOTTED["foot_height_sd"].plot.unit == "mm"
