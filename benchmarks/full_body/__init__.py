"""The thesis's full-body studies (its chapter 4.2 and Table 4.4): every claim beside its measurement, on one page."""
