//! The same sweep by a real Slurm: a controller and one node of it, private, without root, on the loopback alone.
//!
//! Its programs are Debian's, unpacked by `cargo xtask slurm` under `target/slurm`. Where they are not there the test says so
//! and passes; in CI it fails.

use std::fs;
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::binary::{command, typed};

/// Folder of the unpacked packages. Returns `None` if it does not exist.
fn prefix() -> Option<PathBuf> {
    let target = Path::new(env!("CARGO_BIN_EXE_swimmer"))
        .ancestors()
        .nth(2)?;
    let prefix = target.join("slurm");
    let there = prefix.join("usr/sbin/slurmctld-wlm").exists();
    if there {
        return Some(prefix);
    }
    let said = format!(
        "SKIPPED: no Slurm under {}; `cargo xtask slurm` unpacks Debian's",
        prefix.display()
    );
    assert!(std::env::var_os("CI").is_none(), "{said}");
    eprintln!("{said}");
    None
}

/// A controller and a node, ended with the test.
struct Private {
    folder: tempfile::TempDir,
    prefix: PathBuf,
    daemons: Vec<Child>,
}

fn free_port() -> u16 {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    listener.local_addr().unwrap().port()
}

impl Private {
    fn start(prefix: PathBuf) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name).display().to_string();
        for name in ["state", "spool"] {
            fs::create_dir(folder.path().join(name)).unwrap();
        }
        let host = fs::read_to_string("/proc/sys/kernel/hostname").unwrap();
        let host = host.trim().split('.').next().unwrap_or_default().to_owned();
        let user = rustix::process::getuid().as_raw();
        let configuration = format!(
            "ClusterName=private\nSlurmctldHost={host}(127.0.0.1)\nSlurmctldPort={}\nSlurmdPort={}\n\
             SlurmctldAddr=127.0.0.1\nCommunicationParameters=NoCtldInAddrAny,NoInAddrAny\n\
             AuthType=auth/none\nCredType=cred/none\nSlurmUser={user}\nSlurmdUser={user}\nPluginDir={}\n\
             StateSaveLocation={}\nSlurmdSpoolDir={}\nSlurmctldPidFile={}\nSlurmdPidFile={}\n\
             SlurmctldLogFile={}\nSlurmdLogFile={}\nProctrackType=proctrack/linuxproc\nTaskPlugin=task/none\n\
             SwitchType=switch/none\nMpiDefault=none\nSchedulerType=sched/builtin\nSchedulerParameters=batch_sched_delay=0\n\
             SelectType=select/cons_tres\nSelectTypeParameters=CR_Core\nJobAcctGatherType=jobacct_gather/none\n\
             AccountingStorageType=accounting_storage/none\nReturnToService=2\nMailProg=/bin/true\n\
             NodeName={host} NodeAddr=127.0.0.1 CPUs=1 RealMemory=100 State=UNKNOWN\n\
             PartitionName=all Nodes={host} Default=YES MaxTime=INFINITE State=UP\n",
            free_port(),
            free_port(),
            prefix
                .join("usr/lib")
                .join(LIBRARIES)
                .join("slurm-wlm")
                .display(),
            at("state"),
            at("spool"),
            at("slurmctld.pid"),
            at("slurmd.pid"),
            at("slurmctld.log"),
            at("slurmd.log"),
        );
        fs::write(folder.path().join("slurm.conf"), configuration).unwrap();
        let mut cluster = Self {
            folder,
            prefix,
            daemons: Vec::new(),
        };
        let stepd = cluster
            .prefix
            .join("usr/sbin/slurmstepd-wlm")
            .display()
            .to_string();
        for (name, words) in [
            ("slurmctld-wlm", vec!["-D"]),
            ("slurmd-wlm", vec!["-D", "-d", &stepd]),
        ] {
            let mut daemon = cluster.program(&format!("sbin/{name}"));
            let daemon = daemon
                .args(words)
                .stdout(Stdio::null())
                .stderr(Stdio::null());
            cluster.daemons.push(daemon.spawn().unwrap());
        }
        cluster.waits_for("a node", |cluster| {
            cluster.said("bin/sinfo", &["-h", "-o", "%T"]).trim() == "idle"
        });
        cluster
    }

    fn dress(&self, command: &mut Command) {
        let libraries = self.prefix.join("usr/lib").join(LIBRARIES);
        let path = std::env::var("PATH").unwrap_or_default();
        command
            .env("SLURM_CONF", self.folder.path().join("slurm.conf"))
            .env(
                "PATH",
                format!("{}:{path}", self.prefix.join("usr/bin").display()),
            )
            .env(
                "LD_LIBRARY_PATH",
                format!("{0}:{0}/slurm-wlm", libraries.display()),
            );
    }

    fn program(&self, name: &str) -> Command {
        let mut command = Command::new(self.prefix.join("usr").join(name));
        self.dress(&mut command);
        command
    }

    fn said(&self, name: &str, words: &[&str]) -> String {
        let ran = self.program(name).args(words).output().unwrap();
        String::from_utf8_lossy(&ran.stdout).into_owned()
    }

    #[track_caller]
    fn waits_for(&self, what: &str, there: impl Fn(&Self) -> bool) {
        let began = Instant::now();
        while !there(self) {
            let log =
                |name: &str| fs::read_to_string(self.folder.path().join(name)).unwrap_or_default();
            assert!(
                began.elapsed() < Duration::from_mins(2),
                "no {what}\n{}\n{}",
                log("slurmctld.log"),
                log("slurmd.log")
            );
            sleep(Duration::from_millis(200));
        }
    }
}

impl Drop for Private {
    fn drop(&mut self) {
        for daemon in self.daemons.iter_mut().rev() {
            let id = rustix::process::Pid::from_child(daemon);
            let _ = rustix::process::kill_process(id, rustix::process::Signal::TERM);
        }
        for daemon in &mut self.daemons {
            let _ = daemon.wait();
        }
    }
}

#[cfg(target_arch = "x86_64")]
const LIBRARIES: &str = "x86_64-linux-gnu";
#[cfg(not(target_arch = "x86_64"))]
const LIBRARIES: &str = "aarch64-linux-gnu";

/// The study of the book over length ratio and sphere, with fewer designs.
const STUDY: &str = r#"
swimmer = "purcell"
objective = "displacement"
max_rate = 1.0
block = 6
[bounds]
max_angle = 2.4
[[axis]]
name = "drag.chi"
values = [2.0, 3.598]
[[axis]]
name = "links.ratio"
from = 0.8
to = 1.6
count = 8
[[axis]]
name = "sphere.radius"
from = 0.0
to = 0.4
count = 9
"#;

#[test]
fn a_job_array_solves_the_study_and_a_lost_task_is_made_up_for() {
    let Some(prefix) = prefix() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let run = |line: &str| typed(folder.path(), line).with_status(0);
    fs::write(folder.path().join("spec.toml"), STUDY).unwrap();
    for sweep in ["alone", "array"] {
        run(&format!("sweep plan spec.toml -o {sweep}"));
    }
    run("sweep run alone");
    let cluster = Private::start(prefix);
    let words = "sweep submit slurm array --shards 5 --time 10 --submit --json";
    let mut submit = command(folder.path(), &words.split(' ').collect::<Vec<_>>());
    cluster.dress(&mut submit);
    let submitted: crate::binary::Ran = submit.output().unwrap().into();
    let job = submitted.with_status(0).json()["job"]
        .as_str()
        .unwrap()
        .to_owned();
    let done = || run("sweep status array --json").json()["done"] == 144;
    cluster.waits_for("end of the array", |_| done());
    // A node is lost with what one task wrote last: Slurm queues the task again, and it makes up for just that.
    let lost = folder.path().join("array/parts/000000/000000000.part");
    fs::remove_file(&lost).unwrap();
    let again = format!("{job}_1");
    cluster.waits_for("task that is queued again", |cluster| {
        let mut requeue = cluster.program("bin/scontrol");
        requeue
            .args(["requeue", &again])
            .output()
            .unwrap()
            .status
            .success()
    });
    // A task that is queued again waits two minutes, for the node to be repaired; here it need not.
    cluster.waits_for("task that makes up for what was lost", |cluster| {
        let job = format!("JobId={again}");
        cluster.said("bin/scontrol", &["update", &job, "StartTime=now"]);
        done()
    });
    let shards = fs::read_dir(folder.path().join("array/costs"))
        .unwrap()
        .count();
    assert_eq!(shards, 5, "every task of the array ran its own shard");
    let table = |sweep: &str| {
        let merged = run(&format!("sweep merge {sweep} -o {sweep}.parquet --json")).json();
        (
            merged["sha256"].as_str().unwrap().to_owned(),
            merged["certified"].clone(),
        )
    };
    let (ours, certified) = table("array");
    assert_eq!(ours, table("alone").0);
    println!("{certified} of 144 designs certified, by job {job}");
}
