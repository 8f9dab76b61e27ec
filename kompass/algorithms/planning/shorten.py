"""From any collision-free polyline to a short, smooth one that keeps the same clearance."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from kompass.algorithms.distance_field import TOLERANCE, DistanceField
from kompass.algorithms.geometry import Floats

# Places along a path between which straight connections are tried (all pairs: n² / 2).
_CANDIDATES = 64


def path_length(points: Floats) -> float:
    """The length of a polyline (N, 2) [m]."""
    return float(np.hypot(*np.diff(points, axis=0).T).sum())


def spread(points: Floats, spacing: float) -> Floats:
    """A polyline (N, 2) with every leg divided into equal parts of at most ``spacing`` [m].

    All vertices stay, so the result covers exactly the same ground.
    """
    delta = np.diff(points, axis=0)
    parts = np.maximum(1, np.ceil(np.hypot(delta[:, 0], delta[:, 1]) / spacing - 1e-9)).astype(int)
    pieces = [
        points[i] + delta[i] * (np.arange(n)[:, None] / n) for i, n in enumerate(parts.tolist())
    ]
    return np.concatenate([*pieces, points[-1:]])


def resample(points: Floats, spacing: float) -> Floats:
    """A polyline (N, 2) as equally long steps of at most ``spacing`` [m] along it."""
    steps = np.hypot(*np.diff(points, axis=0).T)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    n = max(1, math.ceil(along[-1] / spacing - 1e-9))
    at = np.linspace(0.0, along[-1], n + 1)
    out = np.stack([np.interp(at, along, points[:, 0]), np.interp(at, along, points[:, 1])], axis=1)
    out[0], out[-1] = points[0], points[-1]
    return out


def pull_tight(points: Floats, field: DistanceField, required: float, rounds: int = 3) -> Floats:
    """The shortest way along places of the path, with every clear straight connection allowed.

    Repeated on its own result, whose places lie closer to where the corners should be, until
    nothing is gained. Every leg of the result keeps ``required`` [m] from obstacles.
    """
    best, length = points, path_length(points)
    for _ in range(rounds):
        step = max(length / _CANDIDATES, field.grid.resolution)
        places = np.unique(np.concatenate([_along(best), np.arange(0.0, length, step)]))
        if len(places) > 3 * _CANDIDATES:
            places = np.linspace(0.0, length, 2 * _CANDIDATES)
        candidates = _at(best, places)
        shorter = _shortest_chain(candidates, best, places, field, required)
        gained = length - path_length(shorter)
        if gained <= 1e-6:
            break
        best, length = shorter, length - gained
        if gained < 1e-3 * length:
            break
    return best


def _along(points: Floats) -> Floats:
    return np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])


def _at(points: Floats, places: Floats) -> Floats:
    along = _along(points)
    return np.stack(
        [np.interp(places, along, points[:, 0]), np.interp(places, along, points[:, 1])], axis=1
    )


def _shortest_chain(
    candidates: Floats, path: Floats, places: Floats, field: DistanceField, required: float
) -> Floats:
    """Dynamic programme over candidates in path order; unseen neighbours follow the old path."""
    n = len(candidates)
    i, j = np.triu_indices(n, k=1)
    # On one leg of the path all is clear already.
    along = _along(path)
    first = np.minimum(np.searchsorted(along, places[:-1] + 1e-9) - 1, len(along) - 2)
    ends = np.append(along[first + 1], 0.0) + 1e-9
    visible = np.zeros((n, n), dtype=bool)
    visible[i, j] = one_leg = places[j] <= ends[i]
    i, j = i[~one_leg], j[~one_leg]
    visible[i, j] = field.segments_clear(candidates[i], candidates[j], required)
    # From each place, in its row, back to those before it.
    apart = np.hypot(
        candidates[:, None, 0] - candidates[None, :, 0],
        candidates[:, None, 1] - candidates[None, :, 1],
    )
    apart[~visible.T] = math.inf
    cost = np.full(n, math.inf)
    cost[0] = 0.0
    previous = np.zeros(n, dtype=np.int64)
    straight = np.ones(n, dtype=bool)
    for k in range(1, n):
        through = cost[:k] + apart[k, :k]
        best = int(np.argmin(through))
        # Along the old path one can always go on to the next place.
        onward = cost[k - 1] + float(places[k] - places[k - 1])
        straight[k] = through[best] <= onward
        previous[k], cost[k] = (best, through[best]) if straight[k] else (k - 1, onward)
    chain = [candidates[-1]]
    k = n - 1
    while k > 0:
        before = int(previous[k])
        if not straight[k]:
            inner = (along > places[before] + 1e-9) & (along < places[k] - 1e-9)
            chain.extend(path[inner][::-1])
        chain.append(candidates[before])
        k = before
    return np.array(chain[::-1])


def smooth(
    points: Floats, field: DistanceField, required: float, spacing: float, sweeps: int = 60
) -> Floats:
    """Round the corners of a polyline (N, 2) without giving up clearance.

    An elastic band (Quinlan and Khatib, ICRA 1993): every node is drawn between its neighbours
    and pushed out of the clearance zone along the gradient of the distance. A move counts only
    if both segments at the node stay clear, so the band is valid after every step. Alternating
    over even and odd nodes keeps the neighbours of a moving node at rest.

    Returns nodes at most about ``spacing`` [m] apart; ends stay where they are.
    """
    band = spread(points, spacing)
    n = len(band)
    if n < 3:
        return band
    # A chord between two nodes on a circle of this radius cuts that much off it.
    target = required + spacing * spacing / (4.0 * max(required, spacing))
    still = spacing / 50.0  # m; nodes that move no farther have come to rest
    parts = max(2, math.ceil(spacing / (field.grid.resolution / 2.0)))
    shares = (np.arange(1, parts + 1) / parts)[:, None, None]
    halves = [np.arange(1, n - 1, 2), np.arange(2, n - 1, 2)]
    for _ in range(sweeps):
        moved = 0.0
        for nodes in halves:
            if not nodes.size:
                continue
            here, left, right = band[nodes], band[nodes - 1], band[nodes + 1]
            wanted = (left + right) / 2.0
            lack = target - field.at(wanted)
            close = lack > 0
            if close.any():
                wanted[close] += field.gradient(wanted[close]) * lack[close, None]
            samples = np.concatenate(
                [left + (wanted - left) * shares, right + (wanted - right) * shares]
            )
            clearance = field.at(samples.reshape(-1, 2)).reshape(2 * parts, len(nodes))
            allowed: NDArray[np.bool_] = np.all(clearance >= required - TOLERANCE, axis=0)
            step = np.where(allowed[:, None], wanted - here, 0.0)
            band[nodes] = here + step
            moved = max(moved, float(np.abs(step).max()))
        if moved < still:
            break
    return band
