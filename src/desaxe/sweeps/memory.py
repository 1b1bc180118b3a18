"""Free memory of the system."""

import os


def free_memory() -> int | None:
    """Free memory in bytes; None if the system does not report it."""
    try:
        return os.sysconf("SC_AVPHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    except (AttributeError, OSError, ValueError):
        return None
