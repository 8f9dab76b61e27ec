"""Bring ``.venv`` up to what the checkout says: ``install.py [page] EXTRA...``.

Each part has a stamp of what it was made from and is made again only when that changed: the
packages of each list in ``pyproject.toml``, the ROS interfaces with the editable installation, and
the page (only when asked for). Interfaces, packages and page are made side by side.
"""

import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import threading
import time
import tomllib
from collections.abc import Iterable
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
STAMPS = Path(sys.prefix) / "stamps"
SHARE = Path(sys.prefix) / "share" / "kompass"
PIP = [sys.executable, "-m", "pip", "--disable-pip-version-check", "--no-input"]
# Modules are compiled when they are first imported; most of a hundred packages never are.
INSTALL = [*PIP, "install", "--no-compile", "--no-warn-conflicts", "--progress-bar=off"]


def digest(*said: object, files: Iterable[Path] = ()) -> str:
    """One word for settings, Python version, place of the checkout and contents of files."""
    told = hashlib.sha256(json.dumps([sys.version, str(ROOT), *said]).encode())
    for file in sorted(files):
        told.update(f"{file.relative_to(ROOT)}\0".encode() + file.read_bytes())
    return told.hexdigest()


def files_under(*folders: str) -> list[Path]:
    return [file for folder in folders for file in (ROOT / folder).rglob("*") if file.is_file()]


def page_sources() -> list[Path]:
    """What the page is made from; its tests and the file generated from openapi.json are not."""
    files = [*files_under("web/src", "web/public"), *(ROOT / "web").glob("*.*")]
    files += [ROOT / "cmake" / "build_page.py", ROOT / "cmake" / "npm.py"]
    return [f for f in files if ".test." not in f.name and f.name != "schema.ts" and f.is_file()]


class Job:
    """A command that runs beside others and says how far it is."""

    def __init__(self, name: str, command: list[str]) -> None:
        self.name, self.doing, self.lines = name, "…", list[str]()
        self.begun, self.took = time.monotonic(), 0.0
        self.process = subprocess.Popen(
            command, cwd=ROOT, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT
        )
        self.reader = threading.Thread(target=self._read)
        self.reader.start()

    def _read(self) -> None:
        found = 0
        for line in self.process.stdout or ():
            self.lines.append(line)
            if built := re.match(r"\s*\[(\d+/\d+)\]", line):  # ninja
                self.doing = f"compiled {built[1]}"
            elif "Configuring CMake" in line:
                self.doing = "generating sources"
            elif line.startswith("Collecting"):
                found += 1
                self.doing = f"found {found} packages"
            elif line.startswith("Installing collected packages"):
                self.doing = f"unpacking {line.count(',') + 1} packages"
            elif self.name == "page":
                self.doing = line.strip()
        self.process.wait()
        self.took = time.monotonic() - self.begun


def run(**commands: list[str]) -> None:
    """Run commands side by side; one line says how far they are, and a failure says everything."""
    jobs = [Job(name, command) for name, command in commands.items()]
    begun, every = time.monotonic(), 1 if sys.stdout.isatty() else 15
    while alive := [job for job in jobs if job.reader.is_alive()]:
        alive[0].reader.join(every)
        line = " · ".join(f"{job.name}: {job.doing}" for job in jobs if job.reader.is_alive())
        if line and sys.stdout.isatty():
            width = shutil.get_terminal_size().columns - 1
            print(f"\r\033[K  {time.monotonic() - begun:3.0f} s  {line}"[: width + 4], end="")
        elif line:
            print(f"  {time.monotonic() - begun:3.0f} s  {line}")
        sys.stdout.flush()
    if sys.stdout.isatty():
        print("\r\033[K", end="")
    for job in jobs:
        if job.process.returncode:
            sys.stderr.writelines(job.lines)
            raise SystemExit(f"kompass-console: {job.name} failed; the reason is above.")
        print(f"  {job.name}: {job.took:.0f} s", flush=True)


def link_share() -> None:
    """What recipes find under share/ is the checkout's, so that an edit counts at once."""
    SHARE.mkdir(parents=True, exist_ok=True)
    for name, folder in {
        "params": "kompass/params",
        "maps": "kompass/maps",
        "recipes": "recipes",
    }.items():
        if not (SHARE / name).is_symlink():
            shutil.rmtree(SHARE / name, ignore_errors=True)
            (SHARE / name).symlink_to(ROOT / folder)


def package_lists(asked: list[str]) -> dict[str, list[str]]:
    """Name → requirements: ``build``, ``run``, and each extra that was asked for."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())
    project = settings["project"]
    lists = {"build": settings["build-system"]["requires"], "run": project["dependencies"]}
    extras: dict[str, list[str]] = project["optional-dependencies"]
    if unknown := [each for each in asked if each != "page" and each not in extras]:
        raise SystemExit(
            f"kompass-console: nothing to install is called {unknown[0]!r}; there are: page "
            f"(the console's page), {', '.join(extras)}\n  e.g. scripts/setup page test check"
        )
    others = {f"{project['name']}[{name}]": wanted for name, wanted in extras.items()}
    # An extra may name another one of ours, as it may for pip.
    return lists | {
        extra: [name for each in extras[extra] for name in others.get(each, [each])]
        for extra in asked
        if extra != "page"
    }


def stamps(asked: list[str]) -> dict[str, str]:
    """Part → what it would be made from now."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())
    lists = package_lists(asked)
    now = {name: digest(wanted) for name, wanted in lists.items()}
    now["interfaces"] = digest(
        lists["build"],
        settings["tool"]["scikit-build"],
        {k: settings["project"].get(k) for k in ("name", "version", "dependencies", "scripts")},
        files=[
            *files_under("kompass/interfaces"),
            *(ROOT / "cmake").glob("*.cmake"),
            ROOT / "cmake" / "generate_interfaces.py",
            ROOT / "CMakeLists.txt",
        ],
    )
    if "page" in asked:
        now["page"] = digest(files=page_sources())
    return now


def main() -> None:
    asked = sys.argv[1:]
    lists, now = package_lists(asked), stamps(asked)
    stale = {
        part
        for part, stamp in now.items()
        if not (STAMPS / part).is_file() or (STAMPS / part).read_text() != stamp
    }
    if "page" in asked and not (ROOT / "kompass_console/static/index.html").is_file():
        stale.add("page")
    if not stale:
        return

    print(f"Bringing .venv up to date: {', '.join(sorted(stale))}", flush=True)
    os.environ["PATH"] = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    if "build" in stale:
        run(pip=[*INSTALL, "pip>=25"])  # resolves in half the time of those that come with Python
        tools = [tool for tool in ("cmake", "ninja") if not shutil.which(tool)]
        run(**{"build tools": [*INSTALL, *lists["build"], *tools]})
    commands = {}
    missing = [lists[part] for part in lists if part in stale and part != "build"]
    if wanted := [package for packages in missing for package in packages]:
        commands["packages"] = [*INSTALL, *wanted]
    if "interfaces" in stale:
        commands["interfaces"] = [
            *(*INSTALL, "--verbose", "--no-deps", "--no-build-isolation", "--editable", "."),
        ]
    if "page" in stale:
        commands["page"] = [sys.executable, "cmake/build_page.py"]
    run(**commands)
    link_share()
    STAMPS.mkdir(exist_ok=True)
    for part in stale:
        (STAMPS / part).write_text(now[part])


if __name__ == "__main__":
    main()
