"""Debian packages that only some parts of ancf need."""

import contextlib


@contextlib.contextmanager
def needed(package):
    """Around imports of what a Debian package brings. Where it is missing, the ImportError names it."""
    try:
        yield
    except ModuleNotFoundError as error:
        raise ModuleNotFoundError(
            f"{error}, which this part of ancf needs: apt install {package}", name=error.name
        ) from error
