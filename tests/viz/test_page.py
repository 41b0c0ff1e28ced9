"""The page is whole: no address outside it, nothing that ends its scripts early, data as it was given."""

import json
import re

from mbkf.viz.page import SCRIPTS, asset, embedded, page


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
    assert text.count("</script>") == 2, "markup inside a script would end it"
    assert "MIT License" in text, "the viewer's licence travels with it"


def test_embedded_data_come_back_whatever_they_contain():
    data = {"title": "</script><b>&\"'", "é": [1, None, 2.5]}
    text = embedded("recording", data)
    (inner,) = re.findall(r">(.*)</script>", text)
    assert "<" not in inner
    assert json.loads(inner) == data
