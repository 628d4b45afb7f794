"""Tests deploy/ecflow with the real server: the suite runs to its end, and a failing task is aborted and runs again."""

import os
import pathlib
import re
import unittest

from engine_test import PROGRAM, ROOT, EngineTest, free_port, need, run

SUITE = ROOT / "deploy/ecflow"


class Ecflow(EngineTest):
    def setUp(self) -> None:
        super().setUp()
        self.port = free_port()
        self.environment = {**os.environ, "ECF_PORT": str(self.port), "ECF_HOST": "localhost"}
        # The server writes its checkpoint and log to its working directory. It checks its clock and triggers at the
        # interval --ecfinterval, in seconds.
        self.start("ecflow_server", "ecflow_server", f"--port={self.port}", f"--ecfinterval=1", cwd=self.folder,
                   env={**self.environment, "ECF_HOME": str(self.folder), "ECF_LISTS": str(self.folder / "none")})
        self.wait_for("ecFlow's server", lambda: self.answers("--ping"))
        self.client("--restart")

    def answers(self, *arguments: str) -> bool:
        try:
            self.client(*arguments)
        except AssertionError:
            return False
        return True

    def client(self, *arguments: object) -> str:
        return run("ecflow_client", *arguments, env=self.environment)

    def begin(self, of_shares: dict[int, str] | None = None, **variables: str) -> None:
        """Loads the suite with `variables` and the settings of the test, and starts it. `of_shares` has lines that are
        added to the definitions of single shares, by the share's number.
        """
        text = (SUITE / "thunderhead.def").read_text()
        settings = {
            "ECF_HOME": str(self.folder), "ECF_FILES": str(SUITE / "files"), "ECF_INCLUDE": str(SUITE / "include"),
            "THUNDERHEAD": PROGRAM, "STORM": str(self.storm), "PRODUCTS": str(self.products),
            "FLAGS": "--size 160x90 --device software --quality fast --jobs 1", **variables}
        for name, value in settings.items():
            text, changed = re.subn(rf"(edit {name} +)'.*?'", lambda line: f"{line[1]}'{value}'", text)
            self.assertEqual(changed, 1, name)
        for share, line in (of_shares or {}).items():
            text = text.replace(f"edit SHARE {share}\n", f"edit SHARE {share}\n      {line}\n")
        definition = self.folder / "suite.def"
        definition.write_text(text)
        self.client(f"--load={definition}")
        self.client("--begin=thunderhead")

    def node(self, path: str) -> str:
        """Returns the server's lines for a node, without those of its children."""
        return self.client("--get_state", path)

    def state(self, path: str) -> str:
        text = self.node(path)
        found = re.search(rf"(?:suite|family|task) {pathlib.PurePath(path).name} #.*?state:(\w+)", text)
        return found[1] if found else "unknown"

    def test_the_suite_runs_to_its_end(self) -> None:
        self.begin()
        self.wait_for("the suite's end", lambda: self.state("/thunderhead") == "complete")
        self.expect_each_product_once(self.times, others=1)
        for share in range(4):
            task = self.node(f"/thunderhead/shares/{share}/draw")
            self.assertRegex(task, r"meter products 0 100 \d+ # *100|meter products 0 100 100 *# *100", task)
            self.assertRegex(task, r"event first #.*set|event first # *set", task)
            self.assertRegex(task, r'label product "" # ".*\.png"', task)

    def test_a_failing_task_aborts_and_runs_again(self) -> None:
        self.storm.rename(self.folder / "later")
        self.begin(STORM=str(self.storm))
        draw = "/thunderhead/shares/0/draw"

        def gave_up() -> bool:
            # All values are from one answer, because the task may be submitted again before the next answer.
            task = self.node(draw)
            return "state:aborted" in task and "try:3" in task and "thunderhead ended with 75" in task
        self.wait_for("tasks that gave up", gave_up)
        self.wait_for("all to have given up", lambda: all(
            self.state(f"/thunderhead/shares/{share}/draw") == "aborted"
            and "try:3" in self.node(f"/thunderhead/shares/{share}/draw") for share in range(4)))
        self.assertEqual(self.state("/thunderhead/movie"), "queued")
        # The storm appears only now, because a late share would otherwise find it at its third try.
        (self.folder / "later").rename(self.storm)
        for share in range(4):
            self.client("--force=queued", f"/thunderhead/shares/{share}/draw")
        self.wait_for("the suite's end", lambda: self.state("/thunderhead") == "complete")
        self.expect_each_product_once(self.times, others=1)

    def test_what_another_try_does_not_help_is_not_tried_again(self) -> None:
        bad = self.folder / "bad.nc"
        bad.write_text("no storm")
        # Each share has a different mistake.
        wrong = {0: (64, "FLAGS", "--size none"), 1: (65, "STORM", str(bad)), 2: (78, "FLAGS", "--size 16x9 --device 99")}
        # Share 3 is suspended until it is resumed, and fails with 75 at every try.
        lines = {share: f"edit {name} '{value}'" for share, (_, name, value) in wrong.items()}
        self.begin({**lines, 3: f"edit STORM '{self.folder}/none'\n      defstatus suspended"})
        for share, (code, _, _) in wrong.items():
            draw = f"/thunderhead/shares/{share}/draw"
            self.wait_for("an aborted task", lambda: self.state(draw) == "aborted")
            self.wait_for(f"the reason {code}", lambda: f"thunderhead ended with {code}" in self.node(draw))
        # Share 3 fails after the others. If the server tried the others a second time, it would have done so before the
        # third try of share 3 ends.
        later = "/thunderhead/shares/3/draw"
        self.assertEqual(self.state(later), "queued")
        self.client("--resume=/thunderhead/shares/3")
        self.wait_for("the last try of a share", lambda: self.state(later) == "aborted" and "try:3 " in self.node(later))
        for share in wrong:
            self.assertIn("try:1 ", self.node(f"/thunderhead/shares/{share}/draw"), share)

    def test_a_task_that_is_killed_aborts(self) -> None:
        self.begin(FLAGS="--size 2560x1440 --device software --quality accurate --jobs 1")
        draw = "/thunderhead/shares/0/draw"
        self.wait_for("a running task", lambda: self.state(draw) == "active")
        self.client("--alter=change", "variable", "ECF_TRIES", "1", "/thunderhead")
        self.client("--kill=/thunderhead/shares/0/draw")
        self.wait_for("an aborted task", lambda: self.state(draw) == "aborted")
        self.assertIn("stopped by a signal", self.node(draw))


if __name__ == "__main__":
    need({"ecflow_server": "ecflow-server", "ecflow_client": "ecflow-client"})
    unittest.main()
