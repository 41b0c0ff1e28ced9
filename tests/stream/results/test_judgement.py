"""The judgement of a live run: words as numbers, and all of it as plain data."""

from mbkf.io.limb_doubts import LimbDoubt
from mbkf.io.verdict import PARTS, Reason, Verdict
from mbkf.stream.results.judgement import Judgement

VERDICT = Verdict.of(
    [
        Reason("left_leg", "do not use", "60° beyond its range", "it may be turned over", "check names"),
        Reason("trunk", "look", "9 mm off", "it may be loose", "look at it"),
    ]
)


def test_words_are_numbers_of_the_trial_and_its_parts():
    whole, *parts = Judgement(VERDICT, 2.0).codes
    codes = dict(zip(PARTS, parts, strict=True))
    assert whole == codes["left_leg"] == 2.0 and codes["trunk"] == 1.0 and codes["pelvis"] == 0.0


def test_plain_data_holds_the_verdict_its_words_and_the_limbs():
    doubt = LimbDoubt("left_thigh", "turned over", 0.4, 0.5, mended=True, right_from_s=0.5)
    plain = Judgement(VERDICT, 2.0, (doubt,), ("two persons",)).plain()
    assert plain["overall"] == "do not use" and plain["parts"]["trunk"] == "look"
    assert plain["line"] == VERDICT.line and plain["sentences"] == list(VERDICT.sentences)
    assert plain["notices"] == ["two persons"]
    (limb,) = plain["limb_doubts"]
    assert limb["limb"] == "left_thigh" and limb["sentence"] == doubt.sentence and plain["time_s"] == 2.0
