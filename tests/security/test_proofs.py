"""A proof is of one request, to one service, once; any change of any of it breaks it."""

from __future__ import annotations

import copy
import importlib
import itertools
from typing import Any

import pytest
from hypothesis import strategies as st
from kompass_interfaces.action import BacktestRules
from kompass_interfaces.msg import HandCommand
from kompass_interfaces.srv import (
    ApplyRules,
    ChangeMissions,
    ChangePlaces,
    ChangeZones,
    CheckGoal,
    ConfirmRules,
    GetCmdList,
    GetHistory,
    GetPredictedOccupancies,
    ReleaseStop,
    ResetRule,
    RollbackRules,
    SaveRecording,
    SignedCall,
    TakeWheel,
)
from rclpy.serialization import deserialize_message, serialize_message

from kompass.signing.canonical import canonical_bytes
from kompass.signing.key import NoKey, RobotKey
from kompass.signing.proof import LIFE, Verifier, announce, make_proof, read_challenge
from kompass.signing.session_key import SessionKey
from tests.support.properties import property_test

KEY, OTHER_KEY = RobotKey.new(), RobotKey.new()
SERVICE = "/monitor/apply_rules"
KINDS = [
    *(ApplyRules.Request, RollbackRules.Request, ConfirmRules.Request, ResetRule.Request),
    *(ReleaseStop.Request, SaveRecording.Request, GetHistory.Request, SignedCall.Request),
    *(TakeWheel.Request, ChangePlaces.Request, ChangeMissions.Request, ChangeZones.Request),
    *(BacktestRules.Goal, CheckGoal.Request, GetCmdList.Request),
]
TEXTS = st.text(st.characters(blacklist_characters="\0", blacklist_categories=["Cs"]), max_size=20)
LIMITS = {"uint32": 32, "uint64": 64, "uint8": 8}


def values(kind: str) -> st.SearchStrategy[Any]:
    """Values of a field's type."""
    if kind == "string":
        return TEXTS
    if kind == "boolean":
        return st.booleans()
    if kind in LIMITS:
        return st.integers(0, 2 ** LIMITS[kind] - 1)
    if kind == "double":
        return st.floats(allow_nan=False)
    if kind == "sequence<string>":
        return st.lists(TEXTS, max_size=4)
    if kind == "sequence<uint8>":
        return st.lists(st.integers(0, 255), max_size=9)
    return st.nothing()


@st.composite
def requests(draw: st.DrawFn) -> Any:
    """A request of a kind that carries a proof, with something in every field."""
    kind = draw(st.sampled_from([one for one in KINDS if hasattr(one, "proof")]))
    return kind(**{name: draw(values(of)) for name, of in proved_fields(kind).items()})


def proved_fields(kind: Any) -> dict[str, str]:
    """Names and types of all fields but the proof."""
    fields: dict[str, str] = kind.get_fields_and_field_types()
    return {name: of for name, of in fields.items() if name != "proof"}


def signed(request: Any, verifier: Verifier, service: str = SERVICE, key: RobotKey = KEY) -> Any:
    found = read_challenge(verifier.announcement, [KEY])
    assert found is not None
    request.proof = make_proof(key, found[0], service, request)
    return request


def over_the_wire(request: Any) -> Any:
    """What the server gets."""
    return deserialize_message(serialize_message(request), type(request))


@property_test(requests(), st.data())
def test_any_change_of_any_field_breaks_the_proof(request: Any, data: st.DataObject) -> None:
    verifier = Verifier(KEY, 0.0)
    proved = signed(request, verifier)
    for name, kind in proved_fields(request).items():
        changed = copy.deepcopy(proved)
        setattr(changed, name, data.draw(values(kind), label=name))
        if repr(changed) == repr(proved):  # not ==: -0.0 is not 0.0
            continue
        assert verifier.judge(SERVICE, over_the_wire(changed), 1.0) == "wrong", name
    assert verifier.judge(SERVICE, over_the_wire(proved), 1.0) == "good"


@property_test(requests(), st.integers(min_value=0), st.sampled_from("0123456789abcdef"))
def test_any_change_of_the_proof_itself_breaks_it(request: Any, at: int, digit: str) -> None:
    verifier = Verifier(KEY, 0.0)
    proved = signed(request, verifier)
    place = at % len(proved.proof)
    changed = proved.proof[:place] + digit + proved.proof[place + 1 :]
    whole, proved.proof = proved.proof, changed
    verdict = verifier.judge(SERVICE, proved, 1.0)
    assert (verdict == "good") == (changed == whole)


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_bytes_are_the_same_before_and_after_the_wire(kind: Any) -> None:
    request = kind()
    assert canonical_bytes(over_the_wire(request)) == canonical_bytes(request)


def test_a_rounded_number_is_the_same_before_and_after_the_wire() -> None:
    request = GetPredictedOccupancies.Request(time_step=0.1)  # a float32
    assert over_the_wire(request).time_step != request.time_step
    assert canonical_bytes(over_the_wire(request)) == canonical_bytes(request)


def test_where_one_field_ends_and_the_next_begins_counts() -> None:
    one = ApplyRules.Request(author="av", role="aengineer")
    other = ApplyRules.Request(author="ava", role="engineer")
    assert canonical_bytes(one) != canonical_bytes(other)
    assert KEY.sign(b"ab", b"c") != KEY.sign(b"a", b"bc")


def test_what_ros_cuts_off_a_text_is_no_part_of_the_request() -> None:
    request = ApplyRules.Request(author="good\0bad", reset=["a\0b"])
    assert over_the_wire(request).author == "good"
    assert canonical_bytes(over_the_wire(request)) == canonical_bytes(request)


def test_a_proof_is_good_once() -> None:
    verifier = Verifier(KEY, 0.0)
    request = signed(ReleaseStop.Request(operator_name="ava"), verifier)
    assert verifier.judge(SERVICE, request, 1.0) == "good"
    assert verifier.judge(SERVICE, request, 2.0) == "used"


def test_a_proof_is_of_one_service_and_one_key() -> None:
    verifier = Verifier(KEY, 0.0)
    request = signed(ReleaseStop.Request(), verifier)
    assert verifier.judge("/other/release_stop", request, 1.0) == "wrong"
    assert verifier.judge(SERVICE, signed(request, verifier, key=OTHER_KEY), 1.0) == "wrong"


def test_a_proof_that_was_held_back_is_worth_nothing_two_minutes_later() -> None:
    verifier = Verifier(KEY, 0.0)
    request = signed(ReleaseStop.Request(), verifier)
    verifier.renew(LIFE)
    late = signed(ReleaseStop.Request(), verifier)
    assert verifier.judge(SERVICE, late, LIFE) == "good"
    verifier.renew(2 * LIFE)
    assert verifier.judge(SERVICE, request, 2 * LIFE) == "stale"
    # Also where nobody has exchanged it: the executor may have hung.
    alone = Verifier(KEY, 0.0)
    assert alone.judge(SERVICE, signed(ReleaseStop.Request(), alone), 2 * LIFE + 1.0) == "stale"


def test_a_proof_that_is_on_its_way_while_the_challenge_is_exchanged_still_counts() -> None:
    verifier = Verifier(KEY, 0.0)
    request = signed(ReleaseStop.Request(), verifier)
    verifier.renew(LIFE)
    assert verifier.judge(SERVICE, request, LIFE + 0.1) == "good"
    assert verifier.judge(SERVICE, request, LIFE + 0.2) == "used"


def test_a_proof_is_worth_nothing_after_a_restart() -> None:
    request = signed(ReleaseStop.Request(), Verifier(KEY, 0.0))
    assert Verifier(KEY, 0.0).judge(SERVICE, request, 0.1) == "stale"


def test_what_is_remembered_of_proofs_is_bounded_and_forgets_none_that_still_counts(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("kompass.signing.proof.MOST_PROOFS", 50)
    verifier = Verifier(KEY, 0.0)
    used = []
    for number in range(300):
        used.append(signed(ReleaseStop.Request(operator_name=str(number)), verifier))
        assert verifier.judge(SERVICE, used[-1], 1.0) == "good"
    remembered = sum(len(nonces) for _, nonces in verifier._challenges.values())
    assert remembered <= 100
    assert {verifier.judge(SERVICE, again, 1.0) for again in used} == {"used", "stale"}


@pytest.mark.parametrize("proof", ["", ".", "..", "a.b", "x.y.z", "....", "ü.\ud800.é", "a" * 9999])
def test_a_proof_that_is_none_is_refused_and_breaks_nothing(proof: str) -> None:
    verifier = Verifier(KEY, 0.0)
    request = ReleaseStop.Request()
    request.proof = proof
    assert verifier.judge(SERVICE, request, 0.0) == "stale"
    challenge = verifier.announcement.partition(".")[0]
    request.proof = f"{challenge}.{proof}"
    assert verifier.judge(SERVICE, request, 0.0) == "wrong"


def test_only_who_has_the_key_gives_out_challenges() -> None:
    assert read_challenge(announce(KEY, "word"), [OTHER_KEY, KEY]) == ("word", KEY)
    assert read_challenge(announce(OTHER_KEY, "word"), [KEY]) is None
    assert read_challenge(announce(KEY, "word").replace("word", "wort"), [KEY]) is None
    assert read_challenge("", [KEY]) is None


@pytest.mark.parametrize("text", ["", "00", "z" * 64, "0" * 63, "0" * 66, "5" * 62 + "\n"])
def test_what_is_no_key_is_told(text: str) -> None:
    with pytest.raises(NoKey, match="a key"):
        RobotKey.read(text)


def test_a_key_does_not_show_itself() -> None:
    assert KEY.text not in f"{KEY!r} {KEY}"
    assert RobotKey.read(f" {KEY.text}\n").text == KEY.text
    made = {RobotKey.new().text for _ in itertools.repeat(None, 20)}
    assert len(made) == 20


NOT_OFFERED = [
    *("GetCmdList", "GetPredictedOccupancies", "GetPredictedTrajectories", "PathFromToFile"),
    *("Save2dMapToFile", "Save3dMapToFile", "StartPathRecording", "StopVisionTracking"),
]
# What moves nothing and changes nothing that lasts, or must be open to everybody.
WITHOUT_PROOF = {
    "CheckGoal": "it only asks",
    "StopRobot": "anybody may stop the robot",
    "SetFault": "the embedded robot alone has faults",
    **dict.fromkeys(NOT_OFFERED, "nothing of ours offers it"),
}


def test_every_service_of_ours_carries_a_proof_or_has_a_reason_to_carry_none() -> None:
    module = importlib.import_module("kompass_interfaces.srv")
    kinds = {name: kind for name, kind in vars(module).items() if hasattr(kind, "Request")}
    unproved = {name for name, kind in kinds.items() if not hasattr(kind.Request, "proof")}
    assert unproved == set(WITHOUT_PROOF)


# -- messages of a session -------------------------------------------------------------------


def hand(**fields: Any) -> HandCommand:
    given = {"session": "s", "sequence": 1, "sent": 2.5, "vx": 0.1, "vy": 0.0, "omega": -0.3}
    return HandCommand(**(given | fields))


def test_a_message_of_a_session_is_believed_as_it_was_sent_and_in_no_other_way() -> None:
    key = SessionKey(KEY, "session", "seed")
    sent = over_the_wire(key.sign(hand()))
    assert SessionKey(KEY, "session", "seed").has_signed(sent)
    for name, value in (("sequence", 2), ("sent", 2.6), ("vx", 0.2), ("session", "t")):
        changed = copy.deepcopy(sent)
        setattr(changed, name, value)
        assert not key.has_signed(changed), name
    for proof in ("", sent.proof[:-1], "é"):
        assert not key.has_signed(hand(proof=proof))


@pytest.mark.parametrize(
    "other",
    [
        SessionKey(OTHER_KEY, "session", "seed"),
        SessionKey(KEY, "another", "seed"),
        SessionKey(KEY, "session", "another"),
        SessionKey(KEY, "sessions", "eed"),
    ],
)
def test_a_session_does_not_believe_what_another_has_signed(other: SessionKey) -> None:
    assert not SessionKey(KEY, "session", "seed").has_signed(other.sign(hand()))
