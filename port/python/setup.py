"""setup.py: the package "smr" of a wheel: smr.py, and beside it the shared library, which `make shared` builds here.

SMR_LIBRARY names a library to take instead. What is built lies in the build directory of the sources.

SPDX-License-Identifier: MIT
"""
import os
import re
import shutil
import subprocess

from setuptools import setup
from setuptools.command.build_py import build_py

try:
    from setuptools.command.bdist_wheel import bdist_wheel  # from setuptools 70.1 on
except ImportError:
    from wheel.bdist_wheel import bdist_wheel

HERE = os.path.dirname(os.path.abspath(__file__))
TOP = os.path.dirname(os.path.dirname(HERE))
BUILD = os.path.join(TOP, "build", "python")


class BuildPackage(build_py):
    """Puts smr.py as a package's __init__.py, with the library beside it, where smr.py looks first."""

    def run(self):
        library = os.environ.get("SMR_LIBRARY")
        if not library:
            subprocess.check_call([os.environ.get("MAKE", "make"), "-s", f"-j{os.cpu_count() or 1}", "-C", TOP, "BUILD=build", "shared"])
            library = os.path.join(TOP, "build", "libsmr.so")
        folder = os.path.join(self.build_lib, "smr")
        shutil.rmtree(folder, ignore_errors=True)
        os.makedirs(folder)
        shutil.copyfile(os.path.join(HERE, "smr.py"), os.path.join(folder, "__init__.py"))
        shutil.copyfile(library, os.path.join(folder, "libsmr.so"))


class PlatformWheel(bdist_wheel):
    """A wheel for any Python 3 on this platform: the library does not depend on the interpreter."""

    def finalize_options(self):
        super().finalize_options()
        self.root_is_pure = False

    def get_tag(self):
        return ("py3", "none", super().get_tag()[2])


with open(os.path.join(TOP, "include", "smr.h"), encoding="utf-8") as header:
    version = ".".join(re.findall(r"#define SMR_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)", header.read()))
os.makedirs(BUILD, exist_ok=True)
setup(version=version, packages=["smr"], package_dir={"smr": "."},
      cmdclass={"build_py": BuildPackage, "bdist_wheel": PlatformWheel},
      options={"build": {"build_base": BUILD}, "egg_info": {"egg_base": BUILD}})
