"""The search behind `peak`: its text for numba, the module around it, and where it looks."""

WITHOUT_COURSE = ("status", "margin")  # what has no course over theta, and no peak
