#!/bin/bash
# A Slurm of one node on this machine, from Debian's packages, without systemd; needs root.
# Usage: slurm_node.sh start|stop FOLDER     FOLDER keeps configuration, state, logs and pids
# `start` ends when the node takes jobs, with 3 if Slurm can neither be found nor installed, with 4 if
# this machine has a configuration of its own.
set -euo pipefail
action=${1:?start or stop}
folder=$(realpath -m "${2:?folder}")
host=$(hostname -s)
cpus=$(nproc)
memory=$(awk '/MemTotal/ { print int($2 / 1024 * 0.8) }' /proc/meminfo)
# Jobs run without the variables of who submitted them, so only this place is known to all.
system=/etc/slurm/slurm.conf
export SLURM_CONF=$folder/slurm.conf

running() { [ -s "$folder/$1.pid" ] && kill -0 "$(cat "$folder/$1.pid")" 2>/dev/null; }

install_missing() {
    command -v slurmctld >/dev/null && command -v slurmd >/dev/null && command -v munged >/dev/null && return
    export DEBIAN_FRONTEND=noninteractive
    { apt-get update -q && apt-get install -y -q --no-install-recommends slurm-wlm munge; } >"$folder/apt.log" 2>&1
}

configure() {
    cat >"$SLURM_CONF" <<CONF
ClusterName=onenode
SlurmctldHost=$host(127.0.0.1)
NodeName=$host NodeAddr=127.0.0.1 CPUs=$cpus RealMemory=$memory State=UNKNOWN
PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE OverSubscribe=NO State=UP
SlurmUser=root
SlurmdUser=root
SlurmctldPort=26817
SlurmdPort=26818
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket
CryptoType=crypto/munge
MpiDefault=none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/linux
JobAcctGatherFrequency=task=1
JobAcctGatherParams=OverMemoryKill
AccountingStorageType=accounting_storage/none
JobCompType=jobcomp/filetxt
JobCompLoc=$folder/completed.log
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU_Memory
DefMemPerCPU=$((memory / cpus))
SchedulerParameters=batch_sched_delay=0,sched_min_interval=0,bf_interval=2,defer_batch=0
ReturnToService=2
MinJobAge=300
KillWait=5
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
CONF
}

start_munge() {
    running munged && return
    head -c 1024 /dev/urandom >"$folder/munge.key"
    chmod 600 "$folder/munge.key"
    munged --socket="$folder/munge.socket" --key-file="$folder/munge.key" --pid-file="$folder/munged.pid" \
        --log-file="$folder/munged.log" --seed-file="$folder/munge.seed" --force 2>>"$folder/munged.log"
}

start() {
    install_missing || { echo "Slurm is not installed and cannot be: see $folder/apt.log" >&2; exit 3; }
    [ ! -e $system ] || [ "$(realpath $system)" = "$SLURM_CONF" ] || { echo "$system belongs to another Slurm" >&2; exit 4; }
    mkdir -p "$folder/state" "$folder/spool" /etc/slurm
    configure
    ln -sfn "$SLURM_CONF" $system
    start_munge
    running slurmctld || slurmctld -c -f "$SLURM_CONF"
    running slurmd || slurmd -f "$SLURM_CONF"
    for _ in $(seq 150); do
        [ "$(sinfo -h -o %t 2>/dev/null)" = idle ] && return
        sleep 0.2
    done
    echo "Slurm does not take jobs: see the logs in $folder" >&2
    exit 1
}

stop() {
    [ "$(realpath $system)" = "$SLURM_CONF" ] || return 0
    scancel --partition=main 2>/dev/null || true
    for name in slurmd slurmctld munged; do
        running $name || continue
        pid=$(cat "$folder/$name.pid")
        kill "$pid"
        for _ in $(seq 100); do
            kill -0 "$pid" 2>/dev/null || break
            sleep 0.1
        done
    done
    rm -f $system
}

mkdir -p "$folder"
"$action"
