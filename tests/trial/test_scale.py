"""From captures to a subject: what is taken from the captures when it is not said."""

from dataclasses import replace

import numpy as np
import pytest

from mbkf.errors import InvalidInput, NotObservable, UnknownName
from mbkf.model.body_file import load_body
from mbkf.model.protocol import load_protocol
from mbkf.scaling.verdict import DOUBTS_KEY
from mbkf.trial.preparation.coverage import INFERRED_KEY, USE_KEY
from mbkf.trial.scale import _upper_body, scale
from tests.motions import capture_of, marker_positions, moderate_pose, protocol_sensor, random_model

MODEL = random_model(np.random.default_rng(1), spread=0.05)


def made(frames=4, protocol="reference36", mass_kg=None, standing=False):
    rng = np.random.default_rng(2)
    sensor, names = protocol_sensor(MODEL, protocol)
    poses = [MODEL.neutral() if standing else moderate_pose(MODEL, rng, spread=0.4) for _ in range(frames)]
    return capture_of(names, marker_positions(sensor, poses), mass_kg=mass_kg)


@pytest.fixture(scope="module")
def subject():
    return scale(made(standing=True), [made()], mass_kg=70.0)


def test_the_protocol_is_found_by_the_marker_names(subject):
    assert subject.protocol == "reference36"
    assert scale(made(protocol="helen_hayes"), mass_kg=70.0).protocol == "helen_hayes"


def test_exact_markers_are_fitted(subject):
    assert subject.mass_kg == 70.0
    assert subject.report["marker_rms_mm"] < 1.0
    assert subject.report["frames"] == 8
    found = np.array(list(subject.scale_factors.values()))
    errors = np.array([one["standard_error"] for one in subject.report["factors"].values()])
    assert (np.abs(found - MODEL.scale) < 1.5 * errors).all()


def test_two_persons_are_refused_until_one_is_chosen():
    one, beside = made(standing=True), np.array([0.0, 1.5, 0.0])
    names = (*one.markers.names, *(f"B:{name}" for name in one.markers.names))
    places = np.concatenate([one.markers.positions_m, one.markers.positions_m + beside], axis=1)
    both = replace(one, markers=replace(one.markers, names=names, positions_m=places))
    with pytest.raises(InvalidInput, match=r"2 persons: .*\(36 markers\).*choose one with --person"):
        scale(both, mass_kg=70.0, protocol="reference36")


def test_some_points_of_a_second_person_and_a_contradicted_height_are_doubts_of_the_file(subject):
    assert DOUBTS_KEY not in subject.report
    one, beside = made(standing=True), np.array([0.0, 1.5, 0.0])
    names = (*one.markers.names, *(f"*{number}" for number in range(12)))
    places = np.concatenate([one.markers.positions_m, one.markers.positions_m[:, :12] + beside], axis=1)
    both = replace(one, markers=replace(one.markers, names=names, positions_m=places))
    found = scale(both, mass_kg=70.0, height_m=1.3, protocol="reference36")
    second, height = found.report[DOUBTS_KEY][-2:]
    assert "a second person is in view" in second and "1.30 m" in height


def test_a_body_without_markers_on_pelvis_and_legs_is_doubtful_and_one_with_other_names_is_not(subject):
    body = load_body()
    upper = tuple(one for one in subject.markers if one.segment in ("torso", "head"))
    assert _upper_body(subject, body) == []
    (found,) = _upper_body(replace(subject, markers=upper), body)
    assert "torso" in found and "pelvis, legs and feet keep" in found
    legs = tuple(replace(one, segment="femur_r") for one in upper)
    assert (
        _upper_body(
            replace(subject, markers=legs), replace(body, roles=replace(body.roles, legs=("femur_r",)))
        )
        == []
    )


def test_a_protocol_may_be_named_or_given():
    short = made(2)
    by_name = scale(None, [short], mass_kg=70.0, protocol="reference36")
    given = scale(None, [short], mass_kg=70.0, protocol=load_protocol("reference36"))
    assert by_name.scale_factors == given.scale_factors


def test_a_stated_mass_is_used_and_an_own_one_goes_before_it():
    with_mass, without = made(2, mass_kg=65.0), made(2)
    assert scale(without, [with_mass]).mass_kg == 65.0
    assert scale(with_mass, mass_kg=80.0).mass_kg == 80.0


def test_without_a_mass_or_a_trial_nothing_is_scaled():
    with pytest.raises(InvalidInput, match="do not state the body mass; give --mass KG"):
        scale(made(2))
    with pytest.raises(InvalidInput, match="a static trial, or at least one --trial"):
        scale(mass_kg=70.0)


def test_unknown_markers_and_protocols_are_refused():
    strangers = capture_of([f"m{i}" for i in range(10)], np.zeros((3, 10, 3)))
    with pytest.raises(NotObservable, match=r"10 markers .*give --protocol"):
        scale(strangers, mass_kg=70.0)
    with pytest.raises(UnknownName, match="did you mean helen_hayes"):
        scale(made(2), mass_kg=70.0, protocol="helen_hays")


def test_progress_names_its_stage():
    told = []
    scale(made(2), mass_kg=70.0, progress=lambda *step: told.append(step))
    assert told[0][:2] == ("Scaling", 1)


def renamed(capture, kept):
    """The capture with other names for all but the first markers."""
    names = tuple(n if i < kept else f"X{i}" for i, n in enumerate(capture.markers.names))
    return replace(capture, markers=replace(capture.markers, names=names))


def test_a_protocol_that_knows_few_markers_is_used_only_when_it_is_named():
    few = renamed(made(4, standing=True), 17)
    inferred = scale(few, mass_kg=70.0)
    assert (inferred.protocol, inferred.report[USE_KEY]["used"]) == ("inferred", 36)
    assert inferred.report[INFERRED_KEY]["told"].startswith("marker set inferred: 36 markers")
    use = scale(few, mass_kg=70.0, protocol="reference36").report[USE_KEY]
    assert (use["used"], use["markers"], set(use["ignored"])) == (17, 36, {f"X{i}" for i in range(17, 36)})
    assert "17 of 36" in use["warning"]


def test_ignored_markers_change_no_number():
    whole = made(4, standing=True)
    names = (*whole.markers.names, "X", "*3")
    places = np.concatenate([whole.markers.positions_m, np.ones((4, 2, 3))], axis=1)
    more = replace(whole, markers=replace(whole.markers, names=names, positions_m=places))
    plain, found = scale(whole, mass_kg=70.0), scale(more, mass_kg=70.0)
    assert found.scale_factors == plain.scale_factors
    assert list(found.report[USE_KEY]["ignored"]) == ["X"]
    assert not found.report[USE_KEY]["warning"]
    assert plain.report[USE_KEY]["share"] == 1.0


def test_a_marker_that_is_hardly_seen_is_told():
    seldom = made(30, standing=True)
    places = seldom.markers.positions_m.copy()
    places[1:, 0] = np.nan
    seldom = replace(seldom, markers=replace(seldom.markers, positions_m=places))
    use = scale(seldom, mass_kg=70.0).report[USE_KEY]
    assert use["ignored"] == {seldom.markers.names[0]: "seen in 3 % of the frames"}
    assert use["share"] == 1.0
