"""Names that a static trial exchanged and scaling put right, as a subject's report keeps them."""

from __future__ import annotations

from mbkf.io.subject import Subject

STATIC_EXCHANGED_KEY = "static_names_exchanged"
"""Key of a subject's report for the pairs: ``[a, b]``, one after the other."""


def static_exchanges(subject: Subject) -> tuple[tuple[str, str], ...]:
    """Pairs of markers whose names the static trial exchanges, one after the other.

    Args:
        subject: The scaled person.
    """
    found = subject.report.get(STATIC_EXCHANGED_KEY)
    return tuple((str(a), str(b)) for a, b in found) if isinstance(found, list) else ()
