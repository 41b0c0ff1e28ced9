"""A trial's report is a page; what is not there is told."""

from tests.app.asking import asked, plain


def test_a_trial_that_was_run_is_shown(server, cookie):
    answer, text = asked(server, "/trial/report?session=P1&trial=walk1", Cookie=cookie)
    assert answer.status == 404 and b"no result" in text
    plain(server, cookie, "/run?session=P1&do=start", "POST")
    while plain(server, cookie, "/session?session=P1")[1]["run"]["state"] in {"waiting", "running"}:
        pass
    answer, text = asked(server, "/trial/report?session=P1&trial=walk1", Cookie=cookie)
    assert answer.status == 200 and "· report</title>".encode() in text
    assert asked(server, "/trial/other?session=P1&trial=walk1", Cookie=cookie)[0].status == 404
