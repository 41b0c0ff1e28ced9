"""A ticket admits once, a cookie as long as the server lives; neither is the token."""

import pytest

from mbkf.viz.admission import MOST_TICKETS, Admission


@pytest.fixture
def admission():
    return Admission("open sesame; é", "mbkf-page-1")


def test_a_ticket_admits_once(admission):
    used = []
    one, other = admission.ticket(lambda: used.append(1)), admission.ticket()
    assert one != other and not admission.admit("") and not admission.admit("guess")
    assert admission.admit(one) and used == [1] and not admission.admit(one)
    assert admission.admit(other) and used == [1]


def test_old_tickets_expire(admission):
    first = admission.ticket()
    tickets = [admission.ticket() for _ in range(MOST_TICKETS)]
    assert not admission.admit(first) and all(admission.admit(one) for one in tickets)


def test_the_cookie_stands_for_the_token_and_does_not_hold_it(admission):
    told = admission.set_cookie()
    assert (
        told.isascii() and "sesame" not in told and {"HttpOnly", "SameSite=strict"} <= set(told.split("; "))
    )
    pair = told.partition(";")[0]
    assert admission.has_cookie(pair) and admission.has_cookie(f"other=1; {pair}")
    assert Admission("open sesame; é", "mbkf-page-1").has_cookie(pair), (
        "the page that follows at the same address"
    )
    for wrong in (
        "",
        "mbkf-page-1=",
        pair[:-1],
        pair.replace("page-1", "page-2"),
        "mbkf-page-1=é",
        "=;;=",
        "a b=c",
    ):
        assert not admission.has_cookie(wrong)
    assert not Admission("other", "mbkf-page-1").has_cookie(pair)


def test_the_token_is_compared_whatever_it_holds(admission):
    assert (
        admission.is_token("open sesame; é")
        and not admission.is_token("open sesame")
        and not admission.is_token("\ud800")
    )
    assert Admission("", "c").is_token("") and not Admission("x", "c").is_token("")
