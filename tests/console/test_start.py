"""What keeps the console from starting is said in one line, with what to do."""

import pytest
import viser
from pydantic import ValidationError

from kompass_console.scene.viser_hub import ViserHub
from kompass_console.settings import ConsoleSettings


def test_another_viser_is_named_with_the_one_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(viser, "__version__", "9.9.9")
    with pytest.raises(RuntimeError, match=r"viser 9\.9\.9 .* pip install viser==1\.1\.1"):
        ViserHub(lambda *_: None, lambda *_: None)


@pytest.mark.parametrize(
    ("settings", "complaint"),
    [
        ({"access_tokens": {"operator": "short"}}, "use at least 16"),
        ({"access_tokens": {"operator": "x" * 20, "viewer": "x" * 20}}, "give each its own"),
        ({"access_tokens": {}}, "access_tokens"),
        ({"access_tokens": {"operator": "x" * 20}, "colour": "red"}, "colour"),
    ],
)
def test_settings_that_cannot_work_are_refused(settings: dict[str, object], complaint: str) -> None:
    with pytest.raises(ValidationError, match=complaint):
        ConsoleSettings.model_validate(settings)
