"""Sentences of the library are recognised with their values, and said in the words and decimals of a page."""

import re

import pytest

from mbkf.io.verdict import PARTS, TITLES, Reason, Verdict
from mbkf.viz.language import words
from mbkf.viz.sentences import SECTION, contracted, in_languages, recognised, said, with_decimals

LIMB = (
    "the left thigh was in doubt from 1.20 to 2.00 s: its markers lie 22 mm (RMS) from the body, the left shank is 12° "
    "beyond its range; the limb was fitted anew from 2.01 s on"
)


def test_values_are_sentences_parts_or_numbers():
    assert said(LIMB, "es") == (
        "el muslo izquierdo estuvo en duda de 1,20 a 2,00 s: sus marcadores quedan a 22 mm (valor eficaz) del cuerpo, "
        "la pierna izquierda está 12° fuera de su rango; la extremidad se ajustó de nuevo desde 2,01 s"
    )
    assert said(LIMB, "en") == LIMB


def test_pages_name_no_option_in_any_language():
    text = (
        "the plates give 71.2 kg, the subject has 66.0 kg; scale with --mass 71.2 or --mass auto, or check the plates' "
        "units and gains"
    )
    assert said(text, "en").endswith("use 71.2 kg as the mass, or check the plates' units and gains")
    assert "use 71,2 kg como masa" in said(text, "es")
    shown = [one for code in ("en", "es") for one in words(code, SECTION).values()]
    assert [one for one in shown if re.search(r"--\w", one)] == []


def test_a_verdicts_line_is_said_whole():
    reasons = [
        Reason(
            part,
            "look",
            "no marker shows the left toes, right toes",
            "too few markers show them",
            "scale again",
        )
        for part in PARTS[:2]
    ]
    hidden = Reason("left_arm", "do not use", "the capture shows nothing of it", "-", "-", shown=False)
    line = said(Verdict.of([*reasons, hidden]).line, "es")
    assert line == (
        "revisar: pelvis, tronco (no se muestra: miembro superior izquierdo); ningún marcador muestra los dedos del "
        "pie izquierdo, dedos del pie derecho: muy pocos marcadores las muestran; escale de nuevo"
    )
    assert all(said(title, "es") != title or title == "pelvis" for title in TITLES.values())


@pytest.mark.parametrize(
    ("text", "shown"),
    [("64.2 kg", "64,2 kg"), ("-0.5 to 1.25", "-0,5 to 1,25"), ("walk2.5.c3d, mbkf 0.9.1", "walk2.5.c3d, mbkf 0.9.1"),
     ("1.5e-3", "1,5e-3"), ("at 3.", "at 3.")],
)  # fmt: skip
def test_decimals_of_numbers_alone_change(text, shown):
    assert with_decimals(text, "es") == shown and with_decimals(text, "en") == text


def test_names_stay_as_they_are():
    assert said("scaled from walk (standing)", "es") == "escalado con walk (de pie)"
    assert said("there is no session 'walk'", "es") == "no hay ninguna sesión 'walk'"
    assert said("Of a text that nobody wrote: 1.5", "es") == "Of a text that nobody wrote: 1,5"
    assert recognised("Of a text that nobody wrote: 1.5") is None


def test_capitals_full_stops_and_contractions():
    assert said("These frames are left out.", "es") == "Estos fotogramas se dejan fuera."
    assert contracted("de el cuerpo a el lado", "es") == "del cuerpo al lado"
    assert contracted("de el", "en") == "de el"


def test_every_sentence_is_recognised_as_itself():
    """With values that no other sentence has."""
    for key, own in words("es", SECTION).items():
        apart = {
            place[1]: key[place.start() - 1 : place.start()] == "}" for place in re.finditer(r"\{(\d)\}", key)
        }
        values = {k: f", 7{k}" if joined else f"7{k}" for k, joined in apart.items()}
        text = re.sub(r"\{(\d)\}", lambda place, known=values: known[place[1]], key)
        found = said(text, "es")
        assert found == contracted(
            re.sub(r"\{(\d)!?\}", lambda place, known=values: known[place[1]], own), "es"
        ), key


def test_languages_hold_what_differs():
    assert in_languages(["pelvis", "trunk", "trunk"]) == {"en": {}, "es": {"trunk": "tronco"}}


def test_files_are_named_without_their_folders():
    text = "/home/Ana Lab/S1/m51.c3d: cut short inside its parameters (3000 bytes); export it again"
    assert (
        said(text, "es") == "m51.c3d: está cortado dentro de sus parámetros (3000 bytes); expórtelo de nuevo"
    )
    assert said("power in W/kg", "en") == "power in W/kg"


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("RVMH (right foot), PELO (computed by software, by its name)",
         "RVMH (pie derecho), PELO (calculado por un programa, por su nombre)"),
        ("scaled from h61 (trunk and arms: right upper arm turns by 81°)",
         "escalado con h61 (tronco y brazos: brazo derecho gira 81°)"),
        ("axes of plate '1' +2.12 times, mirrored it fits 2.1 times as well",
         "ejes de la plataforma '1' +2,12 veces, en espejo ajusta 2,1 veces mejor"),
        ("the verdict on the motion of the trunk is 'look': these loads are computed from it",
         "el veredicto sobre el movimiento del tronco es 'revisar': estas cargas se calculan con él"),
        ("On a treadmill at 3.53 m/s. Whole cycles: 2 right, 1 left. Mean ± standard deviation between cycles. Strikes "
         "and toe-offs come from the feet's loads if these are known, else from their motion. A step belongs to the "
         "foot that ends it.",
         "En una cinta a 3,53 m/s. Ciclos completos: 2 derechos, 1 izquierdos. Media ± desviación típica entre ciclos. "
         "Apoyos y despegues vienen de las cargas de los pies si se conocen, si no, de su movimiento. Un paso "
         "pertenece al pie que lo termina."),
        ("worst is LASI, and nothing else", "worst is LASI, and nothing else"),
    ],
)  # fmt: skip
def test_lists_brackets_and_values_within_values(text, shown):
    assert said(text, "es") == shown


@pytest.mark.parametrize(
    "text", ["a: " * 1500 + "x", "a (" * 400 + "b" + ")" * 400, "3 of 4 frames, " * 1000, "a" + " /" * 5000]
)
def test_texts_beyond_every_sentence_stay(text):
    assert said(text, "es") == text and recognised(text) is None


def test_members_of_a_list_may_hold_separators_and_an_and_of_their_own():
    facts = "'# convention: clinical' (or isb, model) for its axes and signs, '# persons: 30', '# age: 20-40' (years)"
    assert said(facts, "es") == (
        "'# convention: clinical' (o isb, model) para sus ejes y signos, '# persons: 30' (número de personas), "
        "'# age: 20-40' (edades en años)"
    )
