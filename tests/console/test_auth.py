"""Sessions: who gets one, and when it stops being one."""

from kompass_console.schema.roles import Role
from kompass_console.web.auth import SESSION_LIFETIME, Authenticator, LoginLimiter

TOKENS = {Role.VIEWER: "v" * 20, Role.OPERATOR: "o" * 20}


def test_each_token_opens_its_own_role() -> None:
    auth = Authenticator(TOKENS)
    for role, token in TOKENS.items():
        session = auth.log_in(token, "ava")
        assert session is not None
        assert (session.role, session.user) == (role, "ava")
    assert auth.log_in("x" * 20, "ava") is None


def test_a_cookie_is_still_good_for_the_next_process() -> None:
    session = Authenticator(TOKENS).log_in("o" * 20, None)
    assert session is not None
    cookie = Authenticator(TOKENS).cookie(session)
    assert Authenticator(TOKENS).session(cookie) == session


def test_a_changed_token_ends_the_sessions_opened_with_it() -> None:
    auth = Authenticator(TOKENS)
    session = auth.log_in("o" * 20, None)
    assert session is not None
    assert Authenticator({**TOKENS, Role.OPERATOR: "n" * 20}).session(auth.cookie(session)) is None


def test_a_forged_role_is_refused() -> None:
    auth = Authenticator(TOKENS)
    viewer, operator = auth.log_in("v" * 20, "eve"), auth.log_in("o" * 20, "eve")
    assert viewer is not None
    assert operator is not None
    body = auth.cookie(operator).split(".")[0]
    signature = auth.cookie(viewer).split(".")[1]
    for cookie in (f"{body}.{signature}", "", "a.b", "nonsense", "é.é"):
        assert auth.session(cookie) is None


def test_a_session_ends_with_log_out_and_with_age() -> None:
    now = [1000.0]
    auth = Authenticator(TOKENS, now=lambda: now[0])
    session, other = auth.log_in("o" * 20, "ava"), auth.log_in("o" * 20, "ben")
    assert session is not None
    assert other is not None
    auth.log_out(session)
    assert auth.session(auth.cookie(session)) is None
    assert auth.session(auth.cookie(other)) == other
    now[0] += SESSION_LIFETIME + 1.0
    assert auth.session(auth.cookie(other)) is None


def test_names_are_short_and_printable() -> None:
    session = Authenticator(TOKENS).log_in("o" * 20, "  a\nva\x00  " + "x" * 100)
    assert session is not None
    assert session.user.startswith("ava ")
    assert len(session.user) == 40


def test_wrong_tokens_lock_their_own_address_for_a_while() -> None:
    now = [0.0]
    limiter = LoginLimiter(limit=3, period=60.0, now=lambda: now[0])
    for _ in range(3):
        assert limiter.wait("10.0.0.9") == 0.0
        limiter.failed("10.0.0.9")
    assert limiter.wait("10.0.0.9") > 59.0
    assert limiter.wait("10.0.0.8") == 0.0
    now[0] = 61.0
    assert limiter.wait("10.0.0.9") == 0.0
