"""Tests deploy/systemd: the units are valid and hardened, and start the program with flags that exist."""

import re
import shlex
import shutil
import subprocess
import tempfile
import pathlib
import unittest

from engine_test import PROGRAM, ROOT, need

FOLDER = ROOT / "deploy/systemd"
WATCH = FOLDER / "thunderhead-watch@.service"
# The exposure from systemd-analyze security, from 0 (good) to 10, times ten. This is the unit's present value, rounded
# up.
EXPOSURE = 8


def analyze(*arguments: object) -> subprocess.CompletedProcess:
    return subprocess.run(["systemd-analyze", *map(str, arguments)], capture_output=True, text=True, timeout=6000)


class Systemd(unittest.TestCase):
    def setUp(self) -> None:
        # systemd-analyze needs an instance of a template unit.
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.unit = pathlib.Path(folder.name) / "thunderhead-watch@run42.service"
        self.unit.write_text(WATCH.read_text())

    def test_the_unit_is_sound(self) -> None:
        done = analyze("verify", self.unit)
        # The command also loads the machine's other units, whose mistakes are not ours.
        ours = [line for line in (done.stderr + done.stdout).splitlines() if "thunderhead" in line]
        self.assertEqual(ours, [])
        self.unit.write_text(WATCH.read_text().replace("ProtectSystem=strict", "ProtectSystem=strictly"))
        done = analyze("verify", self.unit)
        self.assertIn("strictly", done.stderr + done.stdout, "a mistake is not found")

    def test_the_unit_is_hardened(self) -> None:
        done = analyze("security", "--offline=true", f"--threshold={EXPOSURE}", "--no-pager", self.unit)
        overall = re.search(r"Overall exposure level.*: ([\d.]+)", done.stdout)
        self.assertIsNotNone(overall, done.stdout + done.stderr)
        self.assertEqual(done.returncode, 0, f"exposure {overall[1]}\n{done.stdout}")
        for setting in ("NoNewPrivileges=yes", "ProtectSystem=strict", "MemoryMax="):
            self.assertIn(setting, WATCH.read_text())

    def test_others_can_read_the_products(self) -> None:
        settings = dict(re.findall(r"^(\w+)=(.*)$", WATCH.read_text(), re.M))
        # The unit must not use a dynamic user, because only root may enter such a user's folders.
        self.assertNotIn("DynamicUser", settings)
        self.assertEqual((settings["StateDirectoryMode"], settings["UMask"]), ("0755", "0022"))
        server = dict(re.findall(r"^(\w+)=(.*)$", (FOLDER / "thunderhead.service").read_text(), re.M))
        for name in ("StateDirectory", "LogsDirectory"):
            self.assertNotEqual(settings["StateDirectory"].partition("/")[0], server[name])
        self.assertEqual(settings["WorkingDirectory"], f"%S/{settings['StateDirectory']}")
        users = (FOLDER / "thunderhead.sysusers").read_text()
        self.assertRegex(users, rf"(?m)^u {settings['User']} ")
        if shutil.which("systemd-sysusers"):
            done = subprocess.run(["systemd-sysusers", "--dry-run", "--inline", *[line for line in users.splitlines() if line[0] != "#"]],
                                  capture_output=True, text=True, timeout=600)
            self.assertEqual(done.returncode, 0, done.stderr)

    def test_the_program_knows_the_flags(self) -> None:
        settings = dict(line.split("=", 1) for line in (FOLDER / "watch.conf").read_text().splitlines()
                        if line and not line.startswith("#"))
        command = re.search(r"^ExecStart=/usr/bin/env thunderhead (.*)$", WATCH.read_text(), re.M)[1]
        words = shlex.split(command.replace("${FOLDER}", settings["FOLDER"]))
        # systemd splits $FLAGS at blanks, and leaves the other words as they are.
        arguments = [part for word in words for part in (settings["FLAGS"].split() if word == "$FLAGS" else [word])]
        arguments = [part.replace("/usr/local/share/thunderhead/views", str(ROOT / "deploy/views")) for part in arguments]
        done = subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, timeout=600, cwd=self.unit.parent)
        # A missing folder may appear later, hence 75. A bad flag would give 64.
        self.assertEqual(done.returncode, 75, done.stderr)
        self.assertIn("there is no such folder", done.stderr)


if __name__ == "__main__":
    need({"systemd-analyze": "systemd"})
    unittest.main()
