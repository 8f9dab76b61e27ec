"""Writes the console's schema to standard output: `python -m kompass_console.openapi`."""

from __future__ import annotations

import json
import sys

from kompass_console.api.app import create_app, openapi


def main() -> None:
    """Print the schema as JSON, keys in a stable order."""
    json.dump(openapi(create_app(None)), sys.stdout, indent=2, sort_keys=True)
    sys.stdout.write("\n")


if __name__ == "__main__":
    main()
