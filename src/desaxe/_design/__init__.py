"""Design questions: what a designer asks of a whole design, not of one crank angle."""
