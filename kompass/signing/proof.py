"""Challenges and proofs as texts: made by who has the key, judged by who takes requests."""

import secrets
import threading
from collections.abc import Iterable
from typing import Any, Literal

from kompass.signing.canonical import canonical_bytes
from kompass.signing.key import RobotKey

LIFE = 60.0  # s after which a challenge is exchanged; the one before counts for as long again
MOST_PROOFS = 10_000  # for one challenge; it is exchanged earlier then

Verdict = Literal["good", "stale", "used", "wrong"]
_CHALLENGE, _REQUEST, _ANSWER = b"kompass challenge", b"kompass request", b"kompass answer"


def make_proof(key: RobotKey, challenge: str, service: str, request: Any) -> str:
    """Prove a request to a service by its full name; each proof is good once."""
    nonce = secrets.token_hex(16)
    mark = key.sign(*_parts(challenge, nonce, service, request))
    return f"{challenge}.{nonce}.{mark}"


def announce(key: RobotKey, challenge: str) -> str:
    """A challenge as it is published: only who has the key makes one."""
    return f"{challenge}.{key.sign(_CHALLENGE, challenge.encode())}"


def read_challenge(text: str, keys: Iterable[RobotKey]) -> tuple[str, RobotKey] | None:
    """The challenge of an announcement and the key it was made with; None if none of these is."""
    challenge, _, mark = text.partition(".")
    for key in keys:
        if key.has_signed(mark, _CHALLENGE, challenge.encode()):
            return challenge, key
    return None


def read_answer(text: str, proof: str, key: RobotKey) -> str | None:
    """The challenge that answers a stale proof; None if it is not of this key and for this proof.

    The mark is over the random word of the proof: an answer to another request is worth nothing.
    """
    challenge, _, mark = text.partition(".")
    return challenge if key.has_signed(mark, _ANSWER, *_words(proof, challenge)) else None


class Verifier:
    """Gives out challenges and judges proofs; any thread. Time is monotonic [s].

    Parameters
    ----------
    key
        Of the robot.
    now
        The time.
    """

    def __init__(self, key: RobotKey, now: float) -> None:
        self._key = key
        self._lock = threading.Lock()
        # Challenge → when it was made, and the nonces that were used with it; the newest last.
        self._challenges: dict[str, tuple[float, set[str]]] = {}
        self.renew(now)

    @property
    def announcement(self) -> str:
        """The newest challenge, to be published."""
        with self._lock:
            return announce(self._key, next(reversed(self._challenges)))

    def answer(self, proof: str) -> str:
        """The newest challenge for whoever made a proof that counts no more."""
        with self._lock:
            challenge = next(reversed(self._challenges))
        return f"{challenge}.{self._key.sign(_ANSWER, *_words(proof, challenge))}"

    def renew(self, now: float) -> None:
        """Exchange the challenge; the one before counts until the next time."""
        with self._lock:
            kept = list(self._challenges.items())[-1:]
            self._challenges = {**dict(kept), secrets.token_hex(16): (now, set())}

    def judge(self, service: str, request: Any, now: float) -> Verdict:
        """Judge the proof of a request to a service by its full name.

        Returns
        -------
        Verdict
            ``good`` once; ``stale`` when its challenge counts no more or never was of this node;
            ``used`` when it was good before; ``wrong`` when it is not of this request, or not of
            this key.
        """
        challenge, nonce, mark = (*request.proof.split(".", 2), "", "")[:3]
        with self._lock:
            made, used = self._challenges.get(challenge, (float("-inf"), set()))
        if now - made > 2 * LIFE:
            return "stale"
        if not self._key.has_signed(mark, *_parts(challenge, nonce, service, request)):
            return "wrong"
        with self._lock:
            if nonce in used:
                return "used"
            used.add(nonce)
            crowded = len(used) >= MOST_PROOFS
        if crowded:
            self.renew(now)
        return "good"


def _words(*words: str) -> tuple[bytes, ...]:
    return tuple(word.encode(errors="surrogatepass") for word in words)


def _parts(challenge: str, nonce: str, service: str, request: Any) -> tuple[bytes, ...]:
    return (_REQUEST, *_words(challenge, nonce, service), canonical_bytes(request))
