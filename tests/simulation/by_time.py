"""Motions by panels of time, also where the energy form would serve."""

from unittest import mock

import desaxe as dx
from desaxe.simulation import request, rows


def by_time(**call):
    """`simulate` without the energy form."""
    with mock.patch.object(request, "tables_alone", no), mock.patch.object(rows, "tables_alone", no):
        return dx.simulate(**call)


def no(*_):
    """The energy form does not serve."""
    return False
