"""A report's words: of the language, or the body's own."""

from mbkf.model.body_file import load_body
from mbkf.trial.gait.convention import BY_CLINIC
from mbkf.viz.session.terms import Terms
from mbkf.viz.wording import wordings


def test_words_of_a_language():
    spanish = Terms("es")
    assert (
        spanish.say("counts", 3, 4, 5) == "Ensayos: 3. Ciclos completos: 4 de la derecha, 5 de la izquierda."
    )
    assert spanish.measure("Step length") == "Longitud de paso" and spanish.measure("other") == "other"
    assert spanish.joint("knee") == "Rodilla" and spanish.joint("own_joint") == "Own joint"
    assert spanish.coordinate("own", "Own title") == "Own title" == spanish.positive("own", "Own title")


def test_english_titles_are_the_bodys():
    known = wordings(load_body("human18").clinical_joints)
    for name, own in known.items():
        if own.turns:
            base = name.removesuffix("_r").removesuffix("_l")
            assert Terms("en").coordinate(base, "missing") == own.title
            assert Terms("es").coordinate(base, "missing") != "missing"
            assert Terms("es").positive(base, "missing") != "missing" != Terms("en").positive(base, "missing")


def test_charts_of_moments_state_the_axes_that_moments_are_about():
    terms = Terms("en", BY_CLINIC, ("pig",))
    assert terms.moment_statement == "clinical, the body's own axes" != terms.statement
