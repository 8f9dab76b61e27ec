"""Properties that hypothesis checks: with a few examples always, with many where nobody waits."""

import os
from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis.strategies import SearchStrategy

FEW = 8
# KOMPASS_EXAMPLES=10000 for a long night.
MANY = int(os.environ.get("KOMPASS_EXAMPLES", "80"))


def few_or_many(many: int, few: int = FEW) -> pytest.MarkDecorator:
    """Run a test with ``examples`` of a few, and again with many and the marker ``slow``."""
    return pytest.mark.parametrize(
        "examples",
        [
            pytest.param(few, id="few"),
            pytest.param(max(many, 1), id="many", marks=pytest.mark.slow),
        ],
    )


def property_test(
    *strategies: SearchStrategy[Any], many: int = MANY
) -> Callable[[Callable[..., None]], Callable[[int], None]]:
    """Make two tests of a check: ``[few]``, and ``[many]`` with the marker ``slow``.

    Parameters
    ----------
    strategies
        Of the arguments of the check, in their order.
    many
        Number of examples of the slow one.
    """

    def decorate(check: Callable[..., None]) -> Callable[[int], None]:
        @few_or_many(many)
        def test(examples: int) -> None:
            tried = settings(
                max_examples=examples,
                deadline=None,
                suppress_health_check=(HealthCheck.too_slow, HealthCheck.data_too_large),
            )
            tried(given(*strategies)(check))()

        test.__name__, test.__qualname__ = check.__name__, check.__qualname__
        test.__module__, test.__doc__ = check.__module__, check.__doc__
        return test

    return decorate
