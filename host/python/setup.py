# SPDX-License-Identifier: MIT-0
# A wheel with the programs and the runtime in it: meson builds them, in a folder of its own, or in PLGEN_BUILD.
import os
import re
import shutil
import subprocess

from setuptools import setup
from setuptools.command.build_py import build_py
from wheel.bdist_wheel import bdist_wheel

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), '..', '..'))


def version():
    with open(os.path.join(ROOT, 'meson.build')) as f:
        return re.search(r"\bversion: '([^']*)'", f.read()).group(1)


class Programs(build_py):
    def run(self):
        super().run()
        build = os.environ.get('PLGEN_BUILD') or os.path.abspath(os.path.join(self.build_lib, '..', 'plgen-meson'))
        if not os.path.exists(os.path.join(build, 'build.ninja')):
            subprocess.check_call(['meson', 'setup', '-Dtests=disabled', build, ROOT])
        subprocess.check_call(['ninja', '-C', build, 'plgen', 'plrun'])
        package = os.path.join(self.build_lib, 'plgen')
        for name in ('plgen', 'plrun'):
            self.mkpath(os.path.join(package, 'bin'))
            shutil.copy2(os.path.join(build, name), os.path.join(package, 'bin', name))
        shutil.copy2(os.path.join(os.path.dirname(os.path.abspath(__file__)), 'plgen', 'py.typed'), package)
        shutil.copytree(os.path.join(ROOT, 'runtime'), os.path.join(package, 'runtime'), dirs_exist_ok=True)
        shutil.copy2(os.path.join(ROOT, 'LICENSE'), package)


class Wheel(bdist_wheel):
    """Of one machine, and of any Python 3."""

    def finalize_options(self):
        super().finalize_options()
        self.root_is_pure = False

    def get_tag(self):
        return ('py3', 'none') + super().get_tag()[2:]


setup(version=version(), cmdclass={'build_py': Programs, 'bdist_wheel': Wheel})
