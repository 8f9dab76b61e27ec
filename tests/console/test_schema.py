"""The schema that the page is typed against is the one this server serves."""

import json
from pathlib import Path

from kompass_console.api.app import create_app, openapi

COMMITTED = Path(__file__).parents[2] / "web" / "openapi.json"


def test_the_committed_schema_is_current() -> None:
    # Write it anew: python -m kompass_console.openapi > web/openapi.json
    assert json.loads(COMMITTED.read_text()) == openapi(create_app(None))


def test_the_state_websocket_messages_are_in_the_schema() -> None:
    schemas = openapi(create_app(None))["components"]["schemas"]
    assert {"StateMessage", "State", "Hello", "Ping", "Pong", "GoalInfo"} <= schemas.keys()


def test_every_reference_leads_somewhere() -> None:
    schema = openapi(create_app(None))
    text = json.dumps(schema)
    names = set(schema["components"]["schemas"])
    for part in text.split('"#/components/schemas/')[1:]:
        assert part.split('"')[0] in names
