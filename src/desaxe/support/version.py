"""The version of this installation."""


def version() -> str:
    """The version as installed, such as "0.1.0"."""
    from importlib.metadata import version

    return version("desaxe")
