"""What is shipped besides our own code: ``dependencies.py write | check | sbom WHEEL | audit``.

``write``   pins what this environment runs with, by hash, in ``requirements.lock``, and lists the
            licences in ``docs/licences.md``
``check``   says where these two no longer fit ``pyproject.toml`` and ``web/package-lock.json``
``sbom``    puts a bill of materials (CycloneDX) into a wheel
``audit``   asks the databases of known vulnerabilities that can be reached
"""

import base64
import hashlib
import importlib.metadata
import json
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
import uuid
import zipfile
from pathlib import Path
from typing import Any, NamedTuple
from xml.etree import ElementTree

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).resolve().parents[1]
LOCK, LICENCES = ROOT / "requirements.lock", ROOT / "docs" / "licences.md"
PROJECT: dict[str, Any] = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
HEAD = """\
# What a release runs with: exactly these files. By scripts/audit --write, from what the tests ran
# with; for Linux on x86_64 with Python {python}. To install a release with it:
#   pip install --require-hashes --requirement requirements.lock
#   pip install --no-deps kompass_console-*.whl
"""
NOT_LOOKED_UP = 3  # exit code: nothing bad was found, and not everything could be asked


class Package(NamedTuple):
    """Something that is shipped or installed with us; ``digest`` is (algorithm, hex)."""

    kind: str  # pypi or npm
    name: str
    version: str
    licence: str
    digest: tuple[str, str]

    @property
    def purl(self) -> str:
        return f"pkg:{self.kind}/{self.name.replace('@', '%40')}@{self.version}"


# -- what there is ---------------------------------------------------------------------------------


def needed() -> list[Requirement]:
    """What we need at run time, on this machine."""
    every = [Requirement(line) for line in PROJECT["dependencies"]]
    return [each for each in every if each.marker is None or each.marker.evaluate()]


def locked() -> dict[str, tuple[str, str]]:
    """Name → version and SHA-256 of what ``requirements.lock`` pins."""
    pins = re.findall(
        r"^(\S+)==(\S+) --hash=sha256:([0-9a-f]{64})$", LOCK.read_text(), flags=re.MULTILINE
    )
    return {name: (version, digest) for name, version, digest in pins}


def python_packages() -> list[Package]:
    return [
        Package("pypi", name, version, python_licence(name), ("SHA-256", digest))
        for name, (version, digest) in locked().items()
    ]


def page_packages() -> list[Package]:
    """What the page is bundled from; tools that only build and test it are not in it."""
    lock = json.loads((ROOT / "web" / "package-lock.json").read_text())["packages"]
    found = []
    for place, said in lock.items():
        if place and not said.get("dev") and not said.get("devOptional"):
            name = place.rpartition("node_modules/")[2]
            algorithm, _, coded = said["integrity"].partition("-")
            digest = (algorithm.upper().replace("SHA", "SHA-"), base64.b64decode(coded).hex())
            found.append(Package("npm", name, said["version"], said.get("license", ""), digest))
    return found


def python_licence(name: str) -> str:
    """As the installed package says it; those of ROS say it in their package.xml alone."""
    told = importlib.metadata.metadata(name)
    folder = name.removeprefix("ros-").removeprefix("jazzy-").replace("-", "_")
    manifest = Path(sys.prefix) / "share" / folder / "package.xml"
    if manifest.is_file():
        said = [each.text or "" for each in ElementTree.parse(manifest).getroot().iter("license")]
        return " AND ".join(said)
    classes = [
        each.rpartition(" :: ")[2]
        for each in told.get_all("Classifier") or []
        if each.startswith("License ::")
    ]
    short = (told.get("License") or "").strip()
    if "\n" in short or len(short) > 40:  # the whole text
        short = ""
    return str(told.get("License-Expression") or short or " AND ".join(classes) or "")


# -- what is written -------------------------------------------------------------------------------


def write_lock() -> None:
    """Pin what is installed here, with the hashes of the files that pip would install again."""
    with tempfile.TemporaryDirectory() as room:
        installed, report = Path(room) / "installed.txt", Path(room) / "report.json"
        installed.write_text(
            "".join(
                f"{each.name}=={each.version}\n"
                for each in importlib.metadata.distributions()
                if canonicalize_name(each.name) != PROJECT["name"]
            )
        )
        pip = [sys.executable, "-m", "pip", "--disable-pip-version-check", "install", "--quiet"]
        into = ["--dry-run", "--ignore-installed", "--report", str(report)]
        wanted = ["--constraint", str(installed), *(str(each) for each in needed())]
        subprocess.run([*pip, *into, *wanted], check=True)
        chosen = json.loads(report.read_text())["install"]
    lines = []
    for each in chosen:
        name = canonicalize_name(each["metadata"]["name"])
        digest = each["download_info"]["archive_info"]["hashes"]["sha256"]
        lines.append(f"{name}=={each['metadata']['version']} --hash=sha256:{digest}\n")
    python = f"{sys.version_info.major}.{sys.version_info.minor}"
    LOCK.write_text(HEAD.format(python=python) + "".join(sorted(lines)))


def licences_page() -> str:
    """The page of licences, from the lock files and what is installed."""
    parts = [
        "# Licences\n",
        "Kompass Console is under Apache-2.0. What is installed with it, or bundled into its\n"
        "page, is under these, as each package says of itself. Made by `scripts/audit --write`;\n"
        "versions and hashes are in `requirements.lock` and `web/package-lock.json`.\n",
    ]
    for title, packages in (("Python", python_packages()), ("The page", page_packages())):
        rows = dict.fromkeys(f"| {each.name} | {each.licence or 'not said'} |" for each in packages)
        parts += [f"## {title}\n", "| package | licence |\n|---|---|", *rows, ""]
    return "\n".join(parts)


def bill() -> dict[str, Any]:
    """The bill of materials, CycloneDX 1.6; the same for the same lock files."""
    packages = [*python_packages(), *page_packages()]
    own = f"pkg:pypi/{PROJECT['name']}@{PROJECT['version']}"
    unique = {each.purl: each for each in packages}
    return {
        "bomFormat": "CycloneDX",
        "specVersion": "1.6",
        "serialNumber": f"urn:uuid:{uuid.uuid5(uuid.NAMESPACE_URL, own + repr(sorted(unique)))}",
        "version": 1,
        "metadata": {
            "component": {
                "type": "application",
                "bom-ref": own,
                "name": PROJECT["name"],
                "version": PROJECT["version"],
                "purl": own,
                "licenses": [{"license": {"id": PROJECT["license"]}}],
            }
        },
        "components": [
            {
                "type": "library",
                "bom-ref": purl,
                "name": each.name,
                "version": each.version,
                "purl": purl,
                "hashes": [{"alg": each.digest[0], "content": each.digest[1]}],
                **({"licenses": [{"license": {"name": each.licence}}]} if each.licence else {}),
            }
            for purl, each in unique.items()
        ],
        "dependencies": [{"ref": own, "dependsOn": sorted(unique)}],
    }


def put_into(wheel: Path) -> None:
    """Add the bill to a wheel, where installers keep it (PEP 770), and to the wheel's record."""
    with zipfile.ZipFile(wheel) as old:
        record = next(name for name in old.namelist() if name.endswith(".dist-info/RECORD"))
        place = record.replace("RECORD", f"sboms/{PROJECT['name']}.cdx.json")
        if place in old.namelist():
            raise SystemExit(f"{wheel} has a bill of materials already; build it again")
        text = json.dumps(bill(), indent=1).encode()
        sha = base64.urlsafe_b64encode(hashlib.sha256(text).digest()).rstrip(b"=").decode()
        made = wheel.with_suffix(".new")
        with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as new:
            for item in old.infolist():
                content = old.read(item)
                if item.filename == record:
                    new.writestr(place, text)
                    content += f"{place},sha256={sha},{len(text)}\n".encode()
                new.writestr(item, content)
    shutil.move(made, wheel)


# -- what is looked at -----------------------------------------------------------------------------


def faults() -> list[str]:
    """Where lock and list of licences no longer fit what we say that we need."""
    if not (LOCK.is_file() and LICENCES.is_file()):
        return ["requirements.lock or docs/licences.md is missing"]
    pins, listed = locked(), LICENCES.read_text()
    found = []
    for wanted in needed():
        version = pins.get(canonicalize_name(wanted.name), ("", ""))[0]
        if not version:
            found.append(f"requirements.lock does not pin {wanted.name}")
        elif not wanted.specifier.contains(version, prereleases=True):
            found.append(f"requirements.lock pins {wanted.name} {version}, not {wanted.specifier}")
    names = {*pins, *(each.name for each in page_packages())}
    shown = set(re.findall(r"^\| (\S+) \|", listed, flags=re.MULTILINE)) - {"package"}
    found += [f"docs/licences.md does not list {name}" for name in sorted(names - shown)]
    found += [f"docs/licences.md lists {name}, which is gone" for name in sorted(shown - names)]
    return found


def ask(name: str, command: list[str], folder: Path) -> Any:
    """What a tool says in JSON; None, with a sentence, when its database cannot be reached."""
    print(f"{name}: ", end="", flush=True)
    try:
        ran = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=300)
    except (OSError, subprocess.TimeoutExpired) as error:
        print(f"not looked up: {error}")
        return None
    try:
        return json.loads(ran.stdout)
    except ValueError:
        last = ran.stderr.strip().splitlines()[-1:] or ["it said nothing"]
        print(f"not looked up: {last[0]}")
        return None


def known_in_python(said: Any) -> list[str]:
    """Vulnerabilities in an answer of pip-audit."""
    return [
        f"{each['name']} {each['version']}: {one['id']}, mended in {one.get('fix_versions') or '—'}"
        for each in said["dependencies"]
        for one in each.get("vulns", [])
    ]


def known_in_page(said: Any) -> list[str]:
    """Vulnerabilities in an answer of npm."""
    return [
        f"{name} {one['range']}: {one['severity']}"
        for name, one in sorted(said["vulnerabilities"].items())
    ]


def audit() -> int:
    """Ask for known vulnerabilities of what is locked; the exit code."""
    found, complete = list[str](), True
    if (tool := Path(sys.executable).with_name("pip-audit")).is_file():
        command = [str(tool), "--format", "json", "--progress-spinner", "off", "--disable-pip"]
        said = ask("Python", [*command, "--require-hashes", "--requirement", str(LOCK)], ROOT)
    else:
        said = None
        print("Python: not looked up: pip-audit is not installed; .venv/bin/pip install pip-audit")
    if said is None:
        complete = False
    else:
        found += (known := known_in_python(said))
        print(f"{len(known)} known vulnerabilities")

    npm = [sys.executable, str(ROOT / "cmake" / "npm.py")]
    said = ask("The page", [*npm, "audit", "--omit=dev", "--json"], ROOT)
    if said is None or "vulnerabilities" not in said:
        complete = False
        if said is not None:
            print(f"not looked up: {said.get('message', said)}")
    else:
        found += (known := known_in_page(said))
        print(f"{len(known)} known vulnerabilities")
    for line in found:
        print(f"  {line}")
    return 1 if found else 0 if complete else NOT_LOOKED_UP


def main(command: str = "", *arguments: str) -> int:
    if command == "write":
        write_lock()
        LICENCES.write_text(licences_page())
    elif command == "check":
        found = faults()
        for each in found:
            print(f"{each}; run scripts/audit --write", file=sys.stderr)
        return 1 if found else 0
    elif command == "sbom" and len(arguments) == 1:
        put_into(Path(arguments[0]))
    elif command == "audit":
        return audit()
    else:
        print(__doc__, file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    raise SystemExit(main(*sys.argv[1:]))
