"""What desaxe computes, measured against a truth that shares nothing with it."""
