"""The ground: what every room may use, and what knows nothing of the mechanism."""
