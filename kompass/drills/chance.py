"""How often equal tables would differ that much by chance, from pairs of drives that differ."""

from __future__ import annotations

from fractions import Fraction
from math import comb

RARE = 0.05  # below which a difference is hardly chance


def sign_test(ups: int, downs: int) -> float:
    """The two-sided exact sign test: of ``ups + downs`` pairs that differ, so many each way.

    With one bit per drive (came through or not) this is the exact form of McNemar's test
    (Psychometrika 12, 1947). Pairs that do not differ tell nothing and are left out.

    Returns
    -------
    float
        The share of repetitions in which equal chances both ways come out at least as uneven;
        1 when no pair differs.

    Raises
    ------
    ValueError
        A number is negative.
    """
    if min(ups, downs) < 0:
        raise ValueError(f"{ups} and {downs} pairs: give numbers of 0 or more")
    pairs = ups + downs
    tail = sum(comb(pairs, number) for number in range(min(ups, downs) + 1))
    return float(min(Fraction(2 * tail, 2**pairs), Fraction(1)))


def in_words(ups: int, downs: int, drives: str) -> str:
    """What :func:`sign_test` says of a difference, as a sentence; ``drives`` says of which."""
    chance = sign_test(ups, downs)
    if not ups + downs:
        return "No pair of drives differs in this."
    of = f"{max(ups, downs)} of {ups + downs} drives {drives} point the same way"
    if chance < RARE:
        return f"Hardly chance: {of} (p = {_number(chance)}, exact sign test)."
    return (
        f"May be chance: {of}, and equal tables would come out as uneven in {_percent(chance)} of "
        f"such drills (p = {_number(chance)}, exact sign test). More drives tell more."
    )


def _number(chance: float) -> str:
    return f"{chance:.2f}" if chance >= 0.1 else f"{chance:.2g}"


def _percent(chance: float) -> str:
    return f"{100 * chance:.0f} %"
