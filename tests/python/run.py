"""Installs client-python as pip does, checks its types, and runs its tests."""

import importlib.util
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
SKIPPED = 77


def main() -> int:
    needed = {"grpc": "python3-grpcio", "google.protobuf": "python3-protobuf", "numpy": "python3-numpy", "PIL": "python3-pil",
              "mypy": "mypy", "pip": "python3-pip", "setuptools": "python3-setuptools", "wheel": "python3-wheel"}
    missing = [package for module, package in needed.items()
               if importlib.util.find_spec(module.partition(".")[0]) is None]
    if missing or shutil.which("grpc_python_plugin") is None:
        print(f"SKIPPED: not installed: {', '.join(missing) or 'protobuf-compiler-grpc'}; ./dev install python does that")
        return SKIPPED
    with tempfile.TemporaryDirectory(prefix="thunderhead-python-") as folder:
        # Works on a copy, because setuptools leaves its own files next to the sources.
        source = pathlib.Path(folder) / "repository"
        for name in ("client-python", "proto"):
            shutil.copytree(ROOT / name, source / name)
        installed = pathlib.Path(folder) / "installed"
        # Without isolation, because Debian's packages provide the build requirements.
        install = [sys.executable, "-m", "pip", "install", "--quiet", "--no-build-isolation", "--no-deps", "--no-index", "--target",
                   str(installed), str(source / "client-python")]
        subprocess.run(install, check=True)
        environment = {**os.environ, "PYTHONPATH": str(installed), "PYTHONDONTWRITEBYTECODE": "1"}
        mypy = [sys.executable, "-m", "mypy", "--config-file", str(source / "client-python/pyproject.toml"), "--cache-dir",
                f"{folder}/mypy"]
        steps = [
            # Checks the installed package, including the code that protoc generated, and then the examples, as their
            # users would.
            [*mypy, "-p", "thunderhead"],
            [*mypy, *map(str, sorted((ROOT / "client-python/examples").glob("*.py")))],
            [sys.executable, str(ROOT / "client-python/tests/test_cases.py")],
            [sys.executable, str(ROOT / "client-python/tests/test_session.py")],
            [sys.executable, str(ROOT / "client-python/tests/test_client.py"), *sys.argv[1:]],
        ]
        return max(subprocess.run(step, env=environment, cwd=folder).returncode for step in steps)


if __name__ == "__main__":
    sys.exit(main())
