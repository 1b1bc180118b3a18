"""Fixtures of the library's tests."""

import pytest

from tests.library.ways import take_way


@pytest.fixture(params=["plain", "compiled"])
def way(request, monkeypatch):
    """Both ways that arrays can take, whatever their size."""
    take_way(monkeypatch, request.param)
    return request.param
