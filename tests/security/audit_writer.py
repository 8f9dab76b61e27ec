"""Writes lines of an audit log in a folder until it is killed."""

import sys
import time
from pathlib import Path

from kompass_console.audit.line import AuditEntry
from kompass_console.audit.log import AuditLog


def main() -> None:
    log = AuditLog(Path(sys.argv[1]))
    number = 0
    while True:
        number += 1
        log.append(AuditEntry(time.time(), "ava", "operator", "", "", f"deed {number}", "done"))
        time.sleep(0.0005)


if __name__ == "__main__":
    main()
