"""Choices of charts: a query's words go before the page's own."""

import pytest

from mbkf.app.charts import Charts
from mbkf.errors import UnknownName
from mbkf.trial.gait.convention import BY_CLINIC


def test_a_query_chooses_and_the_rest_stays():
    page = Charts(colours="green-red")
    assert page.read == BY_CLINIC
    assert page.chosen({"convention": "isb", "moments": ""}) == Charts("isb", "internal", "green-red")
    with pytest.raises(UnknownName, match="x"):
        page.chosen({"convention": "x"}).read  # noqa: B018
