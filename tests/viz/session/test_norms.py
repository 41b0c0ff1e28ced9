"""Sentences on norms: source, persons, ages, speeds and convention, and what became of them in another convention."""

from dataclasses import replace

from mbkf.io.norms import Norms
from mbkf.study.session.norms import norms_of
from mbkf.viz.session.norms import norm_sentences, norms_at_speed, norms_in_report
from mbkf.viz.session.terms import Terms
from tests.study.session.sessions import person


def ours():
    return norms_of([person(), replace(person(1, 6), age=41.5)], "ours")


def test_source_persons_and_convention_are_stated():
    norms = ours()
    (text,) = norm_sentences(norms, norms_in_report(norms, person()), Terms("en"))
    speeds = sorted(one.speed_m_s for one in norms.persons)
    assert text == (
        "Norms ours: the laboratory's own persons; 2 persons, 30 to 41.5 years, "
        f"{speeds[0]:.2f} to {speeds[1]:.2f} m/s; mbkf, the body's own axes."
    )
    foreign = replace(norms, source="Rossi 2019", ages=None, speeds=None)
    (text,) = norm_sentences(foreign, norms_in_report(foreign, person()), Terms("es"))
    assert text == "Normas ours: Rossi 2019; 2 personas; mbkf, ejes propios del cuerpo."
    assert norm_sentences(None, norms_in_report(None, person()), Terms("en")) == []


def test_another_convention_is_named():
    norms = replace(ours(), convention="clinical", axes="pig")
    text = " ".join(norm_sentences(norms, norms_in_report(norms, person()), Terms("en")))
    assert "whose sign alone differs are turned" in text and "Angles of the norms are in other axes" in text
    angles = {key: band for key, band in norms.curves.items() if key[1] == "angle"}
    alone = replace(norms, curves=angles, by_speed={})
    assert norms_in_report(alone, person()) is None
    assert norm_sentences(alone, None, Terms("en"))[1].startswith("The norms are in another convention")
    assert norms_in_report(Norms("n", {}, {}), person()) is None


def test_bands_of_the_speed_count():
    key = ("walk", "angle", "knee_angle")
    fast = replace(ours(), by_speed={(0.1, 9.0): {key: ours().curves[key]}})
    (gait,) = person().gaits
    assert norms_at_speed(fast, gait).name == "ours, 0.1–9.0 m/s" and norms_at_speed(None, gait) is None
