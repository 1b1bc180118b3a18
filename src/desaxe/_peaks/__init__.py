"""The search behind `peak`: its text for numba, the module around it, and where it looks."""
