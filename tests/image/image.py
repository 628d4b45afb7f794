#!/usr/bin/env python3
"""Builds the Dockerfile's image and starts its server once.

Uses buildah or podman if one is installed. Otherwise it runs the build step by step in roots of mmdebstrap, as root.

  image.py check                 checks the instructions and sources of the Dockerfile, in seconds; needs no builder
  image.py build [--ccache DIR]  builds the image and asks the server's /healthz; as slow as a whole build, faster with objects in DIR

Exits with 77 if there is no builder.
"""

import argparse
import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
import urllib.request

ROOT = pathlib.Path(__file__).resolve().parents[2]
SKIPPED = 77
KNOWN = {"FROM", "WORKDIR", "COPY", "RUN", "ENV", "USER", "EXPOSE", "ENTRYPOINT", "CMD"}


def instructions():
    """Returns the Dockerfile's instructions as (name, arguments), with continued lines joined."""
    text = (ROOT / "Dockerfile").read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if not line.lstrip().startswith("#")]
    joined = re.sub(r"\\\n", " ", "\n".join(lines))
    return [tuple(line.split(None, 1)) for line in joined.splitlines() if line.strip()]


def copy_of(arguments):
    """Returns sources, target and stage of a COPY. The stage is None for the build context."""
    words = shlex.split(arguments)
    stage = next((word.removeprefix("--from=") for word in words if word.startswith("--from=")), None)
    paths = [word for word in words if not word.startswith("--")]
    return paths[:-1], paths[-1], stage


def check():
    """Fails with a message if the Dockerfile contains something that cannot be built."""
    found = instructions()
    unknown = {name for name, _ in found} - KNOWN
    assert not unknown, f"the Dockerfile has instructions that image.py does not know: {unknown}"
    stages = []
    for name, arguments in found:
        if name == "FROM":
            stages.append(arguments.split(" AS ")[-1])
            assert arguments.startswith("debian:bookworm-slim"), f"another base: {arguments}"
        if name != "COPY":
            continue
        sources, _, stage = copy_of(arguments)
        assert stage is None or stage in stages, f"COPY from an unknown stage: {arguments}"
        for source in sources if stage is None else []:
            assert (ROOT / source).exists(), f"COPY of what is not there: {source}"
    command = [json.loads(arguments) for name, arguments in found if name in ("ENTRYPOINT", "CMD")]
    assert command[0] == ["thunderhead"] and command[1][0] == "serve", command
    print(f"{len(found)} instructions in {len(stages)} stages")


class Root:
    """A Debian root folder that stands for a stage of the build."""

    def __init__(self, folder, ccache):
        self.folder = folder
        self.ccache = ccache
        self.directory = "/"
        self.environment = {"PATH": "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin", "HOME": "/root"}
        for name in os.environ:
            if name.lower().startswith("npm_config_") or name.lower().endswith("_proxy"):
                self.environment[name] = os.environ[name]
        self.user = "root"
        subprocess.run(
            ["mmdebstrap", "--quiet", "--variant=minbase", "--include=ca-certificates", "bookworm", str(folder)], check=True
        )
        # Files of this machine that the package registry needs. They may hold credentials, so they are mounted while a command
        # of the build runs, and the root itself never contains them.
        self.mounted = {"root/.npmrc": pathlib.Path.home() / ".npmrc"}
        if authorities := os.environ.get("NODE_EXTRA_CA_CERTS", ""):
            self.environment["NODE_EXTRA_CA_CERTS"] = "/root/authorities.pem"
            self.mounted["root/authorities.pem"] = pathlib.Path(authorities)

    def inside(self, path):
        return self.folder / str(pathlib.PurePosixPath(self.directory, path)).lstrip("/")

    def command(self, words):
        """Runs a command in its own namespaces, so that its mounts and processes end with it."""
        mounts = "mount -t proc proc {0}/proc && mount --rbind /dev {0}/dev".format(shlex.quote(str(self.folder)))
        environment = dict(self.environment)
        if self.ccache and self.user == "root":
            (self.folder / "ccache").mkdir(exist_ok=True)
            mounts += f" && mount --bind {shlex.quote(self.ccache)} {shlex.quote(str(self.folder))}/ccache"
            environment |= {"CCACHE_DIR": "/ccache"}
        if self.user == "root":
            for inner, source in self.mounted.items():
                if source.is_file():
                    (self.folder / inner).touch()
                    mounts += f" && mount --bind -o ro {shlex.quote(str(source))} {shlex.quote(str(self.folder / inner))}"
        assigned = " ".join(f"{name}={shlex.quote(value)}" for name, value in environment.items())
        inner = f"cd {shlex.quote(self.directory)} && exec env -i {assigned} {words}"
        line = f"{mounts} && exec chroot --userspec={self.user} {shlex.quote(str(self.folder))} /bin/sh -c {shlex.quote(inner)}"
        return ["unshare", "--mount", "--pid", "--fork", "--kill-child", "/bin/sh", "-c", line]

    def run(self, script):
        subprocess.run(self.command(f"/bin/sh -e -c {shlex.quote(script)}"), check=True)


def copy_context(root, sources, target):
    """Copies tracked files as COPY does. The build context is all tracked files except those in .dockerignore."""
    ignored = [line.strip("/") for line in (ROOT / ".dockerignore").read_text().splitlines() if line]
    for source in sources:
        files = subprocess.run(
            ["git", "ls-files", "-z", "--", source], cwd=ROOT, check=True, capture_output=True, text=True
        ).stdout.split("\0")
        for file in filter(None, files):
            if any(file == entry or file.startswith(entry + "/") for entry in ignored):
                continue
            inner = os.path.relpath(file, source) if (ROOT / source).is_dir() else os.path.basename(file)
            to = root.inside(target) / inner
            to.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / file, to)


def build_in_roots(work, ccache):
    """Builds all stages. Returns the last one, with its entry point and command."""
    stages = {}
    root, entry, command = None, [], []
    for name, arguments in instructions():
        print(f"--- {name} {arguments}", flush=True)
        if name == "FROM":
            label = arguments.split(" AS ")[-1]
            root = stages[label] = Root(work / f"stage{len(stages)}", ccache)
        elif name == "WORKDIR":
            root.directory = arguments
            root.inside(".").mkdir(parents=True, exist_ok=True)
        elif name == "COPY":
            sources, target, stage = copy_of(arguments)
            if stage is None:
                copy_context(root, sources, target)
                continue
            for source in sources:
                origin = stages[stage].folder / source.lstrip("/")
                to = root.inside(target)
                if origin.is_dir():
                    shutil.copytree(origin, to, dirs_exist_ok=True)
                else:
                    to.mkdir(parents=True, exist_ok=True)
                    shutil.copy2(origin, to / origin.name)
        elif name == "RUN":
            root.run(arguments)
        elif name == "ENV":
            for word in shlex.split(arguments):
                key, value = word.split("=", 1)
                root.environment[key] = value.replace("$PATH", root.environment["PATH"])
        elif name == "USER":
            root.user = arguments
        elif name == "ENTRYPOINT":
            entry = json.loads(arguments)
        elif name == "CMD":
            command = json.loads(arguments)
    return root, entry + command


def answers(port, process):
    """Returns True once the server's /healthz answers; False if it ends, or does not answer within ten minutes."""
    for _ in range(3000):
        if process.poll() is not None:
            return False
        try:
            with urllib.request.urlopen(f"http://127.0.0.1:{port}/healthz", timeout=60) as answer:
                return answer.status == 200
        except OSError:
            time.sleep(0.2)
    return False


def start(command, port):
    process = subprocess.Popen(command)
    try:
        assert answers(port, process), "the image's server does not answer"
        print("the image's server answers")
    finally:
        process.terminate()
        try:
            process.wait(600)
        except subprocess.TimeoutExpired:
            process.kill()


def build(arguments):
    builder = shutil.which("buildah") or shutil.which("podman")
    if builder:
        subprocess.run([builder, "build", "-t", "thunderhead-test", str(ROOT)], check=True)
        if shutil.which("podman"):
            port = str(arguments.port)
            start(["podman", "run", "--rm", "-p", f"127.0.0.1:{port}:8080", "thunderhead-test"], arguments.port)
        return 0
    if not shutil.which("mmdebstrap") or os.geteuid() != 0:
        print("skipped: neither buildah nor podman, nor mmdebstrap and root")
        return SKIPPED
    with tempfile.TemporaryDirectory(prefix="thunderhead-image-", dir=arguments.work) as work:
        root, command = build_in_roots(pathlib.Path(work), arguments.ccache)
        leaked = [path for path in root.mounted if (root.folder / path).exists() and (root.folder / path).stat().st_size > 0]
        assert not leaked, f"the image contains {leaked}"
        port = str(arguments.port)
        words = [word.replace("0.0.0.0:8080", f"127.0.0.1:{port}").replace("0.0.0.0:50051", "127.0.0.1:0") for word in command]
        start(root.command(shlex.join(words)), arguments.port)
    return 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=["check", "build"])
    parser.add_argument("--ccache", help="a folder of ccache's to share, so that what is compiled already is not again")
    parser.add_argument("--work", help="where the roots are made; some 6 GB")
    parser.add_argument("--port", type=int, default=18080, help="at which the server is asked")
    arguments = parser.parse_args()
    check()
    return build(arguments) if arguments.what == "build" else 0


if __name__ == "__main__":
    sys.exit(main())
