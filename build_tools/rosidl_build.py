"""Generate and describe the C extension for this package's ROS interfaces.

Everything (C structs, FastDDS and introspection type support, Python conversions) goes in
ONE extension module, <pkg>/<pkg>_s__rosidl_typesupport_c.*.so: the name that the generated
Python classes import. dispatch.c finds the type supports inside it, so no library of this
package has to be on LD_LIBRARY_PATH.
"""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path
from typing import NamedTuple

DEPENDENCIES = [  # direct and indirect interface packages
    "action_msgs",
    "builtin_interfaces",
    "geometry_msgs",
    "service_msgs",
    "std_msgs",
    "trajectory_msgs",
    "unique_identifier_msgs",
]
TYPESUPPORTS = ["rosidl_typesupport_fastrtps_c", "rosidl_typesupport_introspection_c"]


class Generated(NamedTuple):
    """What one run of the generators left on disk."""

    python: list[Path]
    python_root: Path
    c_sources: list[Path]
    include_dirs: list[Path]


def find_prefixes() -> list[Path]:
    """Prefixes holding share/, include/ and lib/ of the ROS install, most specific first."""
    import rosidl_generator_py

    found = [Path(p) for p in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if p]
    # .../<prefix>/lib/pythonX.Y/site-packages/rosidl_generator_py/__init__.py
    found.append(Path(rosidl_generator_py.__file__).resolve().parents[4])
    found.append(Path(sys.prefix))
    out = []
    for p in found:
        if p not in out and (p / "share").is_dir():
            out.append(p)
    return out


def share_of(package: str, prefixes: list[Path]) -> Path:
    for p in prefixes:
        if (p / "share" / package / "package.xml").is_file():
            return p / "share" / package
    raise RuntimeError(f"ROS package {package} not found under {prefixes}")


def _args(path, **kw):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(kw, indent=1))
    return str(path)


def generate(package: str, root: Path, out: Path, interface_files: list[str]) -> Generated:
    """Write the sources of the interface files (relative to root) under out/."""
    from rosidl_adapter import convert_to_idl
    from rosidl_cli.command.helpers import generate_visibility_control_file
    from rosidl_generator_c import generate_c
    from rosidl_generator_py import generate_py
    from rosidl_generator_type_description import generate_type_hash
    from rosidl_typesupport_c import generate_c as generate_typesupport_c
    from rosidl_typesupport_fastrtps_c import generate_typesupport_fastrtps_c
    from rosidl_typesupport_introspection_c import generate_c as generate_introspection_c

    root, out = root.resolve(), out.resolve()
    prefixes = find_prefixes()
    idl_dir = out / "idl" / package
    tuples, sources = [], []
    for f in interface_files:
        rel = Path(f)
        idl = convert_to_idl(root, package, rel, idl_dir)
        tuples.append(f"{idl_dir}:{Path(idl).relative_to(idl_dir).as_posix()}")
        sources.append(str(root / rel))

    deps = []
    for d in DEPENDENCIES:
        deps += [f"{d}:{p}" for p in sorted(share_of(d, prefixes).glob("*/*.idl"))]
    include_paths = [f"{d}:{share_of(d, prefixes)}" for d in DEPENDENCIES]

    hash_dir = out / "type_description" / package
    generate_type_hash(
        _args(
            out / "args_hash.json",
            package_name=package,
            output_dir=str(hash_dir),
            idl_tuples=tuples,
            include_paths=include_paths,
        )
    )
    descriptions = [
        f"{t.rsplit(':', 1)[1]}:{hash_dir / Path(t.rsplit(':', 1)[1]).with_suffix('.json')}"
        for t in tuples
    ]

    # every generator has a folder: two of them write detail/<name>__type_support.c
    def run(name, fn, *extra, visibility=True):
        res = share_of(name, prefixes) / "resource"
        gen = out / name / package
        if visibility:
            generate_visibility_control_file(
                package_name=package,
                template_path=res / f"{name}__visibility_control.h.in",
                output_path=gen / "msg" / f"{name}__visibility_control.h",
            )
        fn(
            _args(
                out / f"args_{name}.json",
                package_name=package,
                output_dir=str(gen),
                template_dir=str(res),
                idl_tuples=tuples,
                ros_interface_dependencies=deps,
                ros_interface_files=sources,
                target_dependencies=[],
                type_description_tuples=descriptions,
            ),
            *extra,
        )

    run("rosidl_generator_c", generate_c)
    run("rosidl_typesupport_fastrtps_c", generate_typesupport_fastrtps_c)
    run("rosidl_typesupport_introspection_c", generate_introspection_c)
    run("rosidl_typesupport_c", generate_typesupport_c, TYPESUPPORTS, visibility=False)

    py_dir = out / "py" / package
    for t in tuples:
        (py_dir / t.rsplit(":", 1)[1]).parent.mkdir(parents=True, exist_ok=True)
    res = share_of("rosidl_generator_py", prefixes) / "resource"
    generate_py(
        _args(
            out / "args_py.json",
            package_name=package,
            output_dir=str(py_dir),
            template_dir=str(res),
            idl_tuples=tuples,
            ros_interface_dependencies=deps,
            target_dependencies=[],
        ),
        ["rosidl_typesupport_c"],
    )

    roots = [out / n for n in ("rosidl_generator_c", *TYPESUPPORTS, "rosidl_typesupport_c", "py")]
    c_sources = [p for r in roots for p in sorted(r.rglob("*.c*")) if p.suffix in (".c", ".cpp")]
    c_sources.append(Path(__file__).resolve().parent / "dispatch.c")
    py_files = sorted(py_dir.rglob("*.py"))
    includes = list(roots)
    for p in prefixes:
        includes.append(p / "include")  # fastcdr/ is not nested in a folder of its own
        includes += sorted(
            d for d in (p / "include").glob("*") if d.is_dir() and not d.name.startswith("python")
        )
    return Generated(py_files, py_dir, c_sources, includes)


def link_settings() -> tuple[list[str], list[Path]]:
    """Return the libraries to link and the folders they are in."""
    prefixes = find_prefixes()
    libs = [
        f"{d}__{k}"
        for d in DEPENDENCIES
        for k in (
            "rosidl_generator_py",
            "rosidl_generator_c",
            "rosidl_typesupport_c",
            *TYPESUPPORTS,
        )
    ]
    libs += [*TYPESUPPORTS, "rosidl_typesupport_fastrtps_cpp", "rosidl_typesupport_c"]
    libs += ["rosidl_runtime_c", "rmw", "rcutils", "fastcdr"]
    dirs = [p / "lib" for p in prefixes]
    return libs, dirs
