# SPDX-License-Identifier: BSD-3-Clause
"""Slurm of one node, this machine: its daemons in a temporary folder, started by hand, killed at will."""

import contextlib
import getpass
import os
import pathlib
import secrets
import socket
import subprocess
import tempfile
import time

PROGRAMS = ["munged", "slurmctld", "slurmd", "sbatch", "scontrol", "squeue"]
CONF = """
ClusterName=bvlab
SlurmctldHost={host}(127.0.0.1)
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CredType=cred/munge
SlurmctldPort={controller_port}
SlurmdPort={node_port}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=sched_min_interval=100000
MpiDefault=none
MailProg=/bin/true
ReturnToService=2
SlurmdTimeout=20
MessageTimeout=10
KillWait=2
NodeName={host} NodeAddr=127.0.0.1 CPUs={cpus} RealMemory=256 State=UNKNOWN
PartitionName=all Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""


def find(program):
    for folder in ["/usr/sbin", "/usr/bin", "/sbin", "/bin", *os.environ["PATH"].split(":")]:
        if os.access(f"{folder}/{program}", os.X_OK):
            return f"{folder}/{program}"
    return None


def missing():
    return [program for program in PROGRAMS if not find(program)]


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for each in sockets:
        each.bind(("127.0.0.1", 0))
    ports = [each.getsockname()[1] for each in sockets]
    for each in sockets:
        each.close()
    return ports


class OneNode:
    """with OneNode() as slurm: commands that get `slurm.environment` talk to it."""

    def __init__(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="bvlab-slurm-", dir="/tmp"))
        self.environment = os.environ | {"SLURM_CONF": str(self.folder / "slurm.conf")}
        self.daemons = {}
        controller_port, node_port = free_ports(2)
        host = socket.gethostname().partition(".")[0]
        (self.folder / "state").mkdir()
        (self.folder / "spool").mkdir()
        (self.folder / "slurm.conf").write_text(CONF.format(
            host=host, user=getpass.getuser(), folder=self.folder, controller_port=controller_port,
            node_port=node_port, cpus=os.cpu_count()))
        (self.folder / "cgroup.conf").write_text("CgroupPlugin=autodetect\n")
        key = self.folder / "munge.key"
        key.write_bytes(secrets.token_bytes(128))
        key.chmod(0o400)
        self.folder.chmod(0o755)

    def __enter__(self):
        try:
            self.start("munged", "--foreground", "--force", f"--socket={self.folder}/munge.socket",
                       f"--key-file={self.folder}/munge.key", f"--pid-file={self.folder}/munged.pid",
                       f"--log-file={self.folder}/munged.log", f"--seed-file={self.folder}/munged.seed")
            self.wait_for(lambda: (self.folder / "munge.socket").exists())
            self.start_controller()
            self.start_node()
            self.wait_for(lambda: "idle" in self.ask("sinfo", "--noheader", "--format=%T"))
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        self.ask("scancel", "--full", "--user", getpass.getuser())
        time.sleep(1)
        for name in ("slurmd", "slurmctld", "munged"):
            self.kill(name)
        subprocess.run(["rm", "-rf", self.folder], check=False)

    def start_controller(self):
        self.start("slurmctld", "-D", "-f", f"{self.folder}/slurm.conf")

    def start_node(self):
        self.start("slurmd", "-D", "-f", f"{self.folder}/slurm.conf")

    def start(self, name, *words):
        with open(self.folder / f"{name}.out", "ab") as out:
            self.daemons[name] = subprocess.Popen([find(name), *words], stdout=out, stderr=out,
                                                  stdin=subprocess.DEVNULL, env=self.environment,
                                                  start_new_session=True)

    def kill(self, name):
        """As a power cut would."""
        daemon = self.daemons.pop(name, None)
        if daemon:
            with contextlib.suppress(ProcessLookupError):
                daemon.kill()
            daemon.wait()

    def ask(self, program, *words):
        done = subprocess.run([find(program), *words], env=self.environment, capture_output=True, text=True)
        return done.stdout

    def wait_for(self, condition, seconds=60):
        end = time.monotonic() + seconds
        while not condition():
            if time.monotonic() > end:
                raise TimeoutError(self.last_words())
            time.sleep(0.1)

    def last_words(self):
        """The last line of each daemon."""
        words = []
        for path in sorted(self.folder.glob("*.log")) + sorted(self.folder.glob("*.out")):
            lines = path.read_text(errors="replace").strip().splitlines()
            words += [f"{path.name}: {lines[-1]}"] if lines else []
        return "; ".join(words)
