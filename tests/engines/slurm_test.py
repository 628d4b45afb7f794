"""Tests deploy/slurm with the real slurmctld, slurmd and munged: an array of four tasks, of which one is killed and one
is requeued.
"""

import getpass
import os
import pathlib
import signal
import socket
import stat
import subprocess
import unittest

from engine_test import PROGRAM, ROOT, EngineTest, free_port, need, run

JOB = ROOT / "deploy/slurm/sequence.sbatch"


class Slurm(EngineTest):
    def setUp(self) -> None:
        super().setUp()
        self.node = socket.gethostname().split(".")[0]
        self.start_munge()
        self.write_config()
        self.environment = {**os.environ, "SLURM_CONF": str(self.folder / "slurm.conf"), "THUNDERHEAD": PROGRAM}
        self.start("slurmctld", "slurmctld", "-D", "-c", env=self.environment)
        self.start("slurmd", "slurmd", "-D", "-N", self.node, env=self.environment)
        self.wait_for("an idle node", lambda: "idle" in self.slurm("sinfo", "-h", "-o", "%T", check=False))

    def start_munge(self) -> None:
        # munged requires that no other user can write to its folders.
        munge = self.folder / "munge"
        munge.mkdir(mode=0o755)
        os.chmod(self.folder, 0o755)
        key = munge / "key"
        key.write_bytes(os.urandom(128))
        key.chmod(stat.S_IRUSR)
        self.socket = munge / "socket"
        # --force is needed because root runs it here, and other users may write to /tmp.
        self.start("munged", "munged", "--foreground", "--force", f"--socket={self.socket}", f"--key-file={key}",
                   f"--pid-file={munge}/pid", f"--log-file={munge}/log", f"--seed-file={munge}/seed")
        self.wait_for("munge's socket", self.socket.exists)

    def write_config(self) -> None:
        for name in ("state", "spool"):
            (self.folder / name).mkdir()
        # Restarted jobs wait for the lifetime of their credentials: 2 s here, 120 s by default.
        (self.folder / "slurm.conf").write_text(f"""
ClusterName=thunderhead
SlurmctldHost={self.node}(127.0.0.1)
SlurmUser={getpass.getuser()}
SlurmdUser={getpass.getuser()}
SlurmctldPort={free_port()}
SlurmdPort={free_port()}
AuthType=auth/munge
AuthInfo=socket={self.socket},cred_expire=2
CredType=cred/munge
StateSaveLocation={self.folder}/state
SlurmdSpoolDir={self.folder}/spool
SlurmctldPidFile={self.folder}/slurmctld.pid
SlurmdPidFile={self.folder}/slurmd.pid
SlurmctldLogFile={self.folder}/slurmctld.log
SlurmdLogFile={self.folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
JobCompType=jobcomp/none
SwitchType=switch/none
MpiDefault=none
ReturnToService=2
SchedulerType=sched/backfill
SchedulerParameters=sched_interval=1,bf_interval=1
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdParameters=config_overrides
KillWait=600
MinJobAge=300
NodeName={self.node} NodeAddr=127.0.0.1 CPUs=4 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
""")

    def slurm(self, *command: object, check: bool = True) -> str:
        return run(*command, check=check, env=self.environment)

    def submit(self, *options: str, more: tuple[str, ...] = ()) -> str:
        return self.slurm(
            "sbatch", "--parsable", f"--output={self.folder}/slurm-%A_%a.out", *options, JOB, self.storm,
            "--product", f"{self.products}/{{storm}}_{{valid:%H%M}}.png", "--size", "320x180", "--device", "software",
            "--jobs", "1", *more).strip()

    def state(self, job: str) -> set[str]:
        return set(self.slurm("squeue", "-h", "-t", "all", "-r", "-j", job, "-o", "%T").split())

    def program_of(self, job: str, task: int) -> int | None:
        """Returns thunderhead's process id in a task of the array; None before the task has drawn a product."""
        if not any(self.products.glob(f"manifest.{task}-of-4.jsonl")):
            return None
        if not (self.products / f"manifest.{task}-of-4.jsonl").read_text():
            return None
        for process in pathlib.Path("/proc").glob("[0-9]*"):
            try:
                environment = (process / "environ").read_bytes().split(b"\0")
                command = (process / "cmdline").read_bytes().split(b"\0")
            except OSError:
                continue
            mine = f"SLURM_ARRAY_JOB_ID={job}".encode() in environment
            if mine and f"SLURM_ARRAY_TASK_ID={task}".encode() in environment and command[0] == PROGRAM.encode():
                return int(process.name)
        return None

    def hold(self, task: int) -> pathlib.Path:
        """Makes a task of the array block when it begins to write its second product. Returns a file. The task
        continues when this file is removed (tests/service/hanging_storage.cc).
        """
        minutes = 10 * (task + 4 + 1)
        mark = self.products / f"run42_{minutes // 60:02d}{minutes % 60:02d}.png.partial.hangs"
        mark.touch()
        return mark

    def use_hanging_storage(self) -> None:
        """Lets the jobs run the program with the library that makes storage hang."""
        program = self.folder / "thunderhead"
        program.write_text(f"#!/bin/sh\nLD_PRELOAD='{os.environ['HANGING_STORAGE']}' exec '{PROGRAM}' \"$@\"\n")
        program.chmod(0o755)
        self.environment["THUNDERHEAD"] = str(program)

    def is_interrupted(self, process: int) -> bool:
        """Returns whether the program has received a signal as a request to stop (server/app/interruption.cc)."""
        for name in pathlib.Path(f"/proc/{process}/task").glob("*/comm"):
            try:
                if name.read_text() == "interrupted\n":
                    return True
            except OSError:
                pass  # The thread has ended.
        return False

    def runs(self, process: int) -> bool:
        """Returns whether the process exists and has not ended. The parent of an ended process may collect it much later."""
        try:
            status = pathlib.Path(f"/proc/{process}/status").read_text()
        except OSError:
            return False
        return "\nState:\tZ" not in status

    def test_an_array_with_a_killed_and_a_requeued_task_makes_every_product_once(self) -> None:
        self.products.mkdir()
        self.use_hanging_storage()
        to_kill, to_requeue = self.hold(2), self.hold(1)
        job = self.submit("--array=0-3")
        movie = self.submit(f"--dependency=afterok:{job}", more=("--movie", f"{self.products}/{{storm}}.webm"))
        killed = self.wait_for("a picture of task 2", lambda: self.program_of(job, 2))
        os.kill(killed, signal.SIGKILL)
        to_kill.unlink()
        requeued = self.wait_for("a picture of task 1", lambda: self.program_of(job, 1))
        self.slurm("scontrol", "requeue", f"{job}_1")
        self.wait_for("the signal to task 1", lambda: not self.runs(requeued) or self.is_interrupted(requeued))
        to_requeue.unlink()
        self.wait_for("the end of task 1", lambda: not self.runs(requeued))
        for mark in self.products.glob("*.hung"):
            mark.unlink()
        before = {entry["file"]: entry["sha256"] for entry in self.entries()}
        self.assertLess(len(before), self.times, "all was drawn before anything could be killed")
        self.wait_for("the array's end", lambda: self.state(job) == {"COMPLETED"})
        self.wait_for("the movie", lambda: self.state(movie) == {"COMPLETED"})
        self.expect_each_product_once(self.times, others=1)
        after = {entry["file"]: entry["sha256"] for entry in self.entries()}
        self.assertEqual(before, {file: after[file] for file in before}, "what was drawn was drawn again")
        for task in (1, 2):
            restarts = self.slurm("scontrol", "show", "job", f"{job}_{task}")
            self.assertIn("Restarts=1", restarts)
        self.assertIn("thunderhead ended with 137: task", (self.folder / f"slurm-{job}_2.out").read_text())

    def test_bad_input_is_not_tried_again(self) -> None:
        bad = self.folder / "bad.nc"
        bad.write_text("no storm")
        self.storm = bad
        job = self.submit("--array=0-0")
        self.wait_for("the job's end", lambda: self.state(job) == {"FAILED"})
        details = self.slurm("scontrol", "show", "job", job)
        self.assertIn("ExitCode=65:0", details)
        self.assertIn("Restarts=0", details)


if __name__ == "__main__":
    need({"slurmctld": "slurmctld", "slurmd": "slurmd", "munged": "munge", "sbatch": "slurm-client"})
    unittest.main()
