"""A session finds its gait by kind."""

from mbkf.io.session import TrialKind
from mbkf.study.session.records import Session
from tests.study.session.sessions import session


def test_gait_by_kind():
    found: Session = session()
    assert found.gait(TrialKind.WALK) is found.gaits[0] and found.gait(TrialKind.RUN) is None
