"""Runs clang-tidy on the files named on standard input, in as many processes at a time as there are processors.

clang-tidy spends nearly all of its time on the headers that a file includes. Twelve files with the same compiler
arguments and checks are therefore examined as one text, as in the unity builds (CMakePresets.json). If something is
found in a text, its files are examined again one by one, and this result counts. With --alone each file is also
compiled alone, which finds a forgotten include.

The checks of a file are those of the nearest .clang-tidy in the folders above it.

A file that passed is examined again only if it, a file of this repository that it includes, its compile command or a
check has changed. BUILD/passed.json records the files that passed, so an interrupted run can be continued. Changes of
the system's headers are not noticed: remove that file after an upgrade. Exits with 1 if clang-tidy or the compiler
found something.
"""

import argparse
import concurrent.futures
import hashlib
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys
import threading
import time

INCLUDE = re.compile(rb'^\s*#\s*include\s*["<]([^">]+)[">]', re.MULTILINE)
# Debian's clang-tidy 14 does not support the coroutines of GCC's library, which Asio uses.
COROUTINES = "gateway/awaitable.h"
FILES_AT_ONCE = 12


def say(text):
    print(f"==> {text}", file=sys.stderr, flush=True)


class Sources:
    """The files of the repository. Each file is read once."""

    def __init__(self, root):
        self.root = root
        self.texts = {}

    def text(self, path):
        if path not in self.texts:
            self.texts[path] = path.read_bytes() if path.is_file() else None
        return self.texts[path]

    def included(self, path, folders):
        """Returns `path` and every file of the repository that it includes, directly or through other files."""
        found, left = set(), [path]
        while left:
            file = left.pop()
            if file in found:
                continue
            found.add(file)
            for name in INCLUDE.findall(self.text(file)):
                for folder in [file.parent, *folders]:
                    candidate = folder / os.fsdecode(name)
                    if self.text(candidate) is not None:
                        left.append(candidate)
                        break
        return found

    def folders(self, command):
        words = shlex.split(command)
        for word, following in zip(words, [*words[1:], ""]):
            folder = following if word in ("-I", "-isystem") else word[2:] if word.startswith("-I") else ""
            if folder and pathlib.Path(folder).is_relative_to(self.root):
                yield pathlib.Path(folder)


def checks_of(root, path):
    """Returns the nearest .clang-tidy in the folders above `path`. The folder `root` has one."""
    return next(folder / ".clang-tidy" for folder in path.parents
                if folder == root or (folder / ".clang-tidy").is_file())


def key_of(sources, files, command, rules):
    digest = hashlib.sha256((rules + command).encode())
    for file in sorted(files):
        digest.update(f"\n{file.relative_to(sources.root)}\n".encode() + sources.text(file))
    return digest.hexdigest()


def arguments_of(command, path):
    """Returns the compiler's arguments for `path`, without input and output."""
    words = iter(shlex.split(command)[1:])
    for word in words:
        if word == "-o":
            next(words)
        elif word not in ("-c", str(path)):
            yield word


def compile_alone(path, arguments):
    """Compiles a file alone, with the build's warnings. Returns the compiler's messages; empty if there are none."""
    result = subprocess.run(["clang++", "-fsyntax-only", "-w", *arguments, str(path)], capture_output=True, text=True)
    return result.stderr if result.returncode else ""


def tidy(path, arguments, options):
    """Runs clang-tidy on a file. Returns its messages; empty if there are none."""
    result = subprocess.run(["clang-tidy", "--quiet", *options, str(path), "--", *arguments], capture_output=True, text=True)
    return result.stdout if result.returncode else ""


def batches_of(todo):
    """Returns groups of at most FILES_AT_ONCE files with the same arguments and checks, ordered by the first file of
    each group."""
    groups = {}
    for item in todo:
        groups.setdefault(item[1:3], []).append(item)
    batches = [group[i:i + FILES_AT_ONCE] for group in groups.values() for i in range(0, len(group), FILES_AT_ONCE)]
    order = {item[0]: i for i, item in enumerate(todo)}
    return sorted(batches, key=lambda batch: order[batch[0][0]])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", help="folder of compile_commands.json")
    parser.add_argument("--seconds", type=float, default=1e9, help="begin no file after so many")
    parser.add_argument("--alone", action="store_true", help="also compile each file by itself")
    parser.add_argument("--checks", default="", help="added to those of .clang-tidy, as clang-tidy's own --checks")
    flags = parser.parse_args()
    end = time.monotonic() + flags.seconds

    root = pathlib.Path.cwd()
    sources = Sources(root)
    build = pathlib.Path(flags.build)
    commands = {pathlib.Path(entry["file"]): entry["command"]
                for entry in json.loads((build / "compile_commands.json").read_text())}
    version = subprocess.run(["clang-tidy", "--version"], check=True, capture_output=True, text=True).stdout
    rules = version + (root / ".clang-tidy").read_text() + flags.checks + ("" if flags.alone else "not alone")
    kept = build / "passed.json"
    passed = set(json.loads(kept.read_text())) if kept.exists() else set()

    todo = []
    known = 0
    for name in sys.stdin.read().split():
        path = root / name
        if path not in commands:
            sys.exit(f"{name} is not in {build}/compile_commands.json; configure that folder again")
        files = sources.included(path, list(sources.folders(commands[path])))
        if root / "server" / COROUTINES in files:
            say(f"left out, as it has coroutines: {name}")
            continue
        config = checks_of(root, path)
        nearest = "" if config.parent == root else config.read_text()
        key = key_of(sources, files, commands[path], rules + nearest)
        if key in passed:
            known += 1
        else:
            todo.append((name, tuple(arguments_of(commands[path], path)), config, key))
    say(f"clang-tidy on {len(todo)} files; {known} passed before and did not change")

    texts = build / "batches"
    texts.mkdir(exist_ok=True)
    lock = threading.Lock()
    failures, left = [], []
    done = 0

    def examine(number, batch):
        nonlocal done
        if time.monotonic() > end:
            left.extend(name for name, *_ in batch)
            return
        _, arguments, config, _ = batch[0]
        options = [f"--config-file={config}"] + ([f"--checks={flags.checks}"] if flags.checks else [])
        found = {name: flags.alone and compile_alone(root / name, arguments) for name, *_ in batch}
        text = texts / f"{number}.cc"
        text.write_text("\n".join((root / name).read_text() for name, *_ in batch))
        if any(found.values()) or tidy(text, arguments, options):
            for name, *_ in batch:
                found[name] = found[name] or tidy(root / name, arguments, options)
        with lock:
            done += len(batch)
            for name, *_, key in batch:
                if found[name]:
                    failures.append(name)
                    print(found[name], flush=True)
                else:
                    passed.add(key)
            fresh = kept.with_suffix(".new")
            fresh.write_text(json.dumps(sorted(passed)))
            fresh.replace(kept)
            say(f"{done} of {len(todo)} files")

    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for outcome in [pool.submit(examine, *item) for item in enumerate(batches_of(todo))]:
            outcome.result()
    if left:
        say(f"out of time: {len(left)} files are left to ./dev check")
    if failures:
        sys.exit(f"something was found in {' '.join(sorted(failures))}")


if __name__ == "__main__":
    main()
