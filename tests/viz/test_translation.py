"""Texts of a page are said in its language: elements and spoken attributes, without code and names."""

from mbkf.viz.translation import translated, translated_data

PAGE = (
    '<style>.a{margin:1.5px}</style><h1 translate="no">scale again <b>1.5</b></h1>'
    '<p title="scale again">scale again</p>'
    "<td>1.5</td><code>1.5</code><i>&lt;b&gt; 2.5</i><svg viewBox='0 0 1.5 2'><title>not known</title></svg>"
)


def test_texts_and_spoken_attributes():
    assert translated(PAGE, "es") == (
        '<style>.a{margin:1.5px}</style><h1 translate="no">scale again <b>1.5</b></h1>'
        '<p title="escale de nuevo">escale de nuevo</p>'
        "<td>1,5</td><code>1.5</code><i>&lt;b&gt; 2,5</i><svg viewBox='0 0 1.5 2'><title>no se conoce</title></svg>"
    )
    assert translated(PAGE, "en") == PAGE


def test_entries_of_plain_data():
    data = {
        "reason": "scale again",
        "name": "scale again",
        "trials": [{"reasons": ["scale again", 3]}],
        "n": 1.5,
    }
    assert translated_data(data, "es", frozenset({"reason", "reasons"})) == {
        "reason": "escale de nuevo",
        "name": "scale again",
        "trials": [{"reasons": ["escale de nuevo", 3]}],
        "n": 1.5,
    }
