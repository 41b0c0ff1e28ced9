"""The trial's segment lengths against those of the subject file: does the file belong to the person in the trial?

The evidence is that of the correction on the trial (:mod:`mbkf.scaling.trial_lengths`), in powers of ten for another
person. A subject of public captures or made from OpenSim bodies has −5 to 1.5 in their own trials, also with one marker
40 mm elsewhere, all markers attached anew or those of a segment moved by 30 mm together.
"""

from __future__ import annotations

from mbkf.errors import NotConverged, NotObservable
from mbkf.io.findings import Finding, judged, not_judged
from mbkf.io.records import MarkerTrajectories
from mbkf.io.subject import Subject
from mbkf.scaling.correction import trial_lengths
from mbkf.scaling.trial_lengths import LengthEvidence

NAME = "segment lengths of the subject"

LOOK, LEAVE = 2.5, 5.0
"""Powers of ten for another person from which a trial calls for a look, and from which it is not to be used."""

REMEDY = ": it is probably another person's file; take that of this person, or scale from a static trial"


def person_finding(lengths: LengthEvidence) -> Finding:
    """Powers of ten for another person than the subject; 0 where the subject's own lengths are more likely.

    Args:
        lengths: Lengths of the trial against those of the subject file.
    """
    changes = changes_in_words(lengths)
    hint = f"{changes} in the trial than in the subject file" if changes else "lengths are those of the file"
    return judged(NAME, max(lengths.powers, 0.0), 0.5 * LOOK, "powers of ten", LEAVE, hint, REMEDY)


def changes_in_words(lengths: LengthEvidence) -> str:
    """The clearest differences of lengths: "thigh 38 ± 9 mm longer"; empty without any.

    Args:
        lengths: Lengths of a trial against those of a subject file.
    """
    return ", ".join(
        f"{one.name} {abs(one.longer_mm):.0f} ± {one.sd_mm:.0f} mm {'longer' if one.longer_mm > 0 else 'shorter'}"
        for one in lengths.changes
    )


def finding_of_markers(subject: Subject, markers: MarkerTrajectories) -> Finding:
    """A finding on segment lengths by a few frames of a trial or of a live run, without a correction of markers.

    Args:
        subject: The person.
        markers: Markers under the subject's names.
    """
    try:
        return person_finding(trial_lengths(subject, markers))
    except (NotObservable, NotConverged) as error:
        return not_judged(NAME, "powers of ten", LEAVE, str(error))
