"""The build_ext command that generates, compiles and places a package's ROS interfaces."""

from __future__ import annotations

import os
import shutil
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import rosidl_build
from setuptools.command.build_ext import build_ext


def build_ext_for(package: str, root: Path, interfaces: list[str]) -> type[build_ext]:
    """Return a build_ext for the interface files (relative to root) of one package.

    The generated .py halves go beside the extension module: into the wheel, or into the
    source tree for an editable install.
    """

    class BuildInterfaces(build_ext):
        def run(self):
            import numpy

            generated = rosidl_build.generate(
                package, root, Path(self.build_temp) / "rosidl", interfaces
            )
            libraries, library_dirs = rosidl_build.link_settings()
            (extension,) = self.extensions
            extension.sources = [os.path.relpath(s) for s in generated.c_sources]
            extension.include_dirs += [*map(str, generated.include_dirs), numpy.get_include()]
            extension.libraries += libraries
            extension.library_dirs += [str(d) for d in library_dirs]
            self._generated = generated
            super().run()
            in_place = self.inplace or self.editable_mode
            target = root / package if in_place else Path(self.build_lib) / package
            for source, destination in self._python_files(target):
                destination.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(source, destination)

        def build_extension(self, ext):
            compile_serially = self.compiler.compile

            def compile_in_parallel(sources, **options):
                with ThreadPoolExecutor(os.cpu_count()) as pool:
                    jobs = [pool.submit(compile_serially, [s], **options) for s in sources]
                    return [out for job in jobs for out in job.result()]

            self.compiler.compile = compile_in_parallel
            super().build_extension(ext)

        def get_outputs(self):
            python = self._python_files(Path(self.build_lib) / package)
            return super().get_outputs() + [str(destination) for _, destination in python]

        def _python_files(self, target: Path) -> list[tuple[Path, Path]]:
            generated = self._generated
            return [(p, target / p.relative_to(generated.python_root)) for p in generated.python]

    return BuildInterfaces
