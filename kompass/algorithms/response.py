"""How a base answers commands along one axis: first order with a delay, fitted to what it did."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from kompass.algorithms.geometry import Floats

STEP = 0.01  # s; of the grid on which the answer is worked out
LONGEST_DELAY = 1.0  # s
LEAST_TIME_CONSTANT, MOST_TIME_CONSTANT = 0.005, 3.0  # s
LEAST_SWING = 0.02  # m/s or rad/s between the least and the greatest command; less tells nothing
LEAST_READINGS = 20
REACTION = 0.1  # s that the drive manager's stop zone allows between a command and its effect
_STARTS = ((0.03, 0.0), (0.1, 0.1), (0.3, 0.1), (0.5, 0.3))  # time constant and delay, s


@dataclass(frozen=True)
class Response:
    """The answer along one axis: ``time_constant · dv/dt + v = gain · u(t − delay)``.

    Attributes
    ----------
    gain
        Speed that is reached, for each m/s or rad/s that was commanded.
    time_constant
        In which a change has come to 63 % [s].
    delay
        From a command to when anything changes [s].
    residual
        Root mean square of what is left between the model and the readings [m/s or rad/s].
    explained
        Share of the readings' variance that the model explains, at most 1.
    """

    gain: float
    time_constant: float
    delay: float
    residual: float
    explained: float

    def deceleration(self, top_speed: float, decel: float) -> float:
        """The deceleration to state in the limits, so that this base stops in the room it is given.

        The stop zone has the robot go on for ``REACTION`` at its speed, and brake then. A base that
        is later than this needs its lateness at that speed in addition.

        Parameters
        ----------
        top_speed
            Of the axis [m/s or rad/s]; above 0.
        decel
            With which commands fall, as the limits state it now [m/s² or rad/s²]; above 0.
        """
        late = max(0.0, self.delay + self.time_constant - REACTION)
        return top_speed / (top_speed / decel + 2.0 * late)


def fit_response(
    command_times: ArrayLike, commands: ArrayLike, times: ArrayLike, speeds: ArrayLike
) -> Response:
    """The response that explains the readings best, in the sense of least squares.

    A command holds until the next one; none before the first counts as 0. Gain and the speed at
    the beginning enter linearly and are solved for; time constant and delay are searched by the
    simplex method of Nelder and Mead ("A simplex method for function minimization", The Computer
    Journal 7, 1965), from several beginnings.

    Parameters
    ----------
    command_times, commands
        When each command was given [s], rising, and what it was [m/s or rad/s]; (N,).
    times, speeds
        When each speed was measured [s], rising, and what it was [m/s or rad/s]; (M,).

    Raises
    ------
    ValueError
        There are too few readings, they are not finite, or the commands hardly change: nothing is
        to be learned from them.
    """
    # A quarter of what a robot loads as it starts; most never fit anything.
    from scipy.optimize import minimize
    from scipy.signal import lfilter

    given_at, given = (np.asarray(one, dtype=np.float64) for one in (command_times, commands))
    at, measured = (np.asarray(one, dtype=np.float64) for one in (times, speeds))
    if len(at) < LEAST_READINGS or not len(given_at):
        raise ValueError(
            f"{len(given_at)} commands and {len(at)} readings; at least 1 and {LEAST_READINGS} "
            "are needed"
        )
    if not all(np.isfinite(one).all() for one in (given_at, given, at, measured)):
        raise ValueError("commands or readings are no finite numbers; leave those out")
    swing = max(float(given.max()), 0.0) - min(float(given.min()), 0.0)
    if swing < LEAST_SWING:
        raise ValueError(
            f"the commands change by {swing:.3f} only; {LEAST_SWING:g} or more tell something"
        )
    grid = np.arange(at[0] - STEP, at[-1] + 2 * STEP, STEP)
    total = _Integral(given_at, given)

    def columns(time_constant: float, delay: float) -> Floats:
        """What a gain of 1 answers, and how a speed at the beginning fades: (M, 2)."""
        mean = np.diff(total(grid - delay)) / STEP
        keep = math.exp(-STEP / time_constant)
        answer = np.concatenate([[0.0], lfilter([1.0 - keep], [1.0, -keep], mean)])
        return np.column_stack([np.interp(at, grid, answer), np.exp(-(at - at[0]) / time_constant)])

    def rest(sought: Floats) -> float:
        answer = columns(*_bounded(sought))
        solved = np.linalg.lstsq(answer, measured, rcond=None)[0]
        return float(np.square(measured - answer @ solved).sum())

    found = [
        minimize(rest, (math.log(tau), delay), method="Nelder-Mead", options={"xatol": 1e-3})
        for tau, delay in _STARTS
    ]
    best = min(found, key=lambda one: one.fun)
    time_constant, delay = _bounded(best.x)
    gain = float(np.linalg.lstsq(columns(time_constant, delay), measured, rcond=None)[0][0])
    spread = float(np.square(measured - measured.mean()).sum())
    return Response(
        gain=gain,
        time_constant=time_constant,
        delay=delay,
        residual=math.sqrt(best.fun / len(at)),
        explained=1.0 - best.fun / spread if spread > 0.0 else 0.0,
    )


def _bounded(sought: Floats) -> tuple[float, float]:
    """Time constant and delay [s] of a place that the search looks at."""
    least, most = math.log(LEAST_TIME_CONSTANT), math.log(MOST_TIME_CONSTANT)
    time_constant = math.exp(min(max(float(sought[0]), least), most))
    return time_constant, min(max(float(sought[1]), 0.0), LONGEST_DELAY)


class _Integral:
    """Of commands that each hold until the next, from long before the first on."""

    def __init__(self, at: Floats, commands: Floats) -> None:
        self._at, self._last = at, float(commands[-1])
        self._sums = np.concatenate([[0.0], np.cumsum(commands[:-1] * np.diff(at))])

    def __call__(self, times: Floats) -> Floats:
        beyond = np.maximum(times - self._at[-1], 0.0) * self._last
        return np.asarray(np.interp(times, self._at, self._sums) + beyond)
