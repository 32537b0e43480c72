"""One thread for the linear algebra of many small systems, where more only wait for each other."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache

from threadpoolctl import ThreadpoolController


@lru_cache(maxsize=1)
def _controller() -> ThreadpoolController:
    """The libraries loaded by now; looking for them takes milliseconds."""
    return ThreadpoolController()


@contextmanager
def one_thread() -> Iterator[None]:
    """Run the body with single-threaded BLAS, whatever the environment says."""
    with _controller().limit(limits=1, user_api="blas"):
        yield
