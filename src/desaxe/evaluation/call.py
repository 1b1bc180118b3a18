"""A checked request with its loads."""

from typing import TYPE_CHECKING, NamedTuple

from ..runtime.request import Request

if TYPE_CHECKING:
    from .under_loads import LoadInputs


class Call(NamedTuple):
    """A checked request, under loads or not; it pickles.

    asked   the request
    inputs  those that are numbers or arrays of the caller
    loads   the inputs that follow from loads which vary with the motion; derivatives are total ones then
    """

    asked: Request
    inputs: tuple[str, ...]
    loads: "LoadInputs | None" = None
