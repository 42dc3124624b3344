"""pip install ./python, in a clone: compiles the C++ core with CMake and packs it with the Python code.

Needs the packages for building that `./lab` installs (docs/install.md), or `apt-get build-dep`'s equivalent.
"""
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent


def version():
    text = (ROOT / "common" / "process" / "version.hpp").read_text(encoding="utf-8")
    return re.search(r'kVersion = "(.*?)"', text).group(1)


class CMakeBuild(build_ext):
    def build_extension(self, ext):
        import pybind11

        out = Path(self.get_ext_fullpath(ext.name)).resolve().parent
        build = Path(self.build_temp).resolve()
        build.mkdir(parents=True, exist_ok=True)
        for tool in ("cmake", "ninja", "lcm-gen"):
            if shutil.which(tool) is None:
                raise SystemExit(f"{tool} is not installed; ./lab build in {ROOT} installs what is needed")
        subprocess.run(["cmake", "-G", "Ninja", "-S", ROOT, "-B", build, "-DCMAKE_BUILD_TYPE=Release",
                        "-DLAB_TESTS=OFF", "-DLAB_BENCHMARKS=OFF", "-DLAB_UNITY_BUILD=ON", "-DLAB_FIRMWARE=OFF",
                        f"-DPython3_EXECUTABLE={sys.executable}", f"-Dpybind11_DIR={pybind11.get_cmake_dir()}"],
                       check=True)
        jobs = os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL", str(os.cpu_count() or 1))
        subprocess.run(["ninja", "-C", build, "-j", jobs, "python"], check=True)
        out.mkdir(parents=True, exist_ok=True)
        made = build / "python" / "active_lab"
        for file in [*made.glob("_core.*.so"), made / "messages.pyi"]:
            shutil.copy(file, out / file.name)


setup(version=version(), packages=["active_lab"], package_data={"active_lab": ["py.typed", "*.pyi"]},
      ext_modules=[Extension("active_lab._core", sources=[])], cmdclass={"build_ext": CMakeBuild})
