"""The page is whole: no address outside it, nothing that ends its scripts early, data as it was given."""

import json
import re

import pytest

from mbkf.viz.page import SCRIPTS, asset, document, embedded, fill, page


def test_nothing_is_loaded_from_elsewhere():
    for text in (page(), page({"scene": {}, "rows": {}})):
        assert re.findall(r"<(?:script|img|iframe|link)[^>]*\b(?:src|href)=[\"'](?!data:)", text) == []
        assert "@import" not in text
        assert "{{" not in text.split("<script>")[0]


def test_a_recording_may_not_connect_anywhere_and_a_live_page_only_to_its_server():
    assert "connect-src 'none'" in page({"a": 1})
    assert "connect-src 'self'" in page()


def test_all_scripts_and_the_viewer_are_inside():
    text = page()
    for name in SCRIPTS:
        assert asset(name).splitlines()[0] in text
    assert "MeshCat" in text
    assert text.count("</script>") == 3, "markup inside a script would end it"
    assert "MIT License" in text, "the viewer's licence travels with it"


def test_embedded_data_come_back_whatever_they_contain():
    data = {"title": "</script><b>&\"'", "é": [1, None, 2.5]}
    text = embedded("recording", data)
    (inner,) = re.findall(r">(.*)</script>", text)
    assert "<" not in inner
    assert json.loads(inner) == data


def test_a_part_that_looks_like_a_place_stays_as_it_is():
    text = fill(
        "report.html", language="en", title="{{body}}", style="", links="", media="", body="<p>{{style}}</p>"
    )
    assert '<title translate="no">{{body}}</title>' in text and "<p>{{style}}</p>" in text
    with pytest.raises(KeyError):
        fill("report.html", language="en")


def test_a_report_has_no_script_and_links_its_sections():
    text = document("es", "a <b>", "p {}", [("one", "One & two")], "<h1>x</h1>")
    assert (
        '<title translate="no">a &lt;b&gt;</title>' in text
        and '<html lang="es">' in text
        and "<h1>x</h1>" in text
    )
    assert (
        '<a href="#one">One &amp; two</a>' in text and "<script" not in text and "default-src 'none'" in text
    )
