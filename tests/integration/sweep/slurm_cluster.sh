#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
#
# slurm_cluster.sh FOLDER COMMAND...: a Slurm cluster of two nodes on this machine, in namespaces of its own, for as long as COMMAND runs.
# Needs root, and Debian's slurmctld, slurmd, slurm-client and munge.
set -euo pipefail
if [ "${1:-}" != --inside ]; then
  exec unshare --net --mount --pid --fork --kill-child --mount-proc "$0" --inside "$@"
fi
folder=$2
shift 2
mkdir -p "$folder"/{state,n1,n2,munge}
ip link set lo up
ip link add cluster type dummy 2>/dev/null || ip link add cluster type veth peer name cluster_end # names are looked up only where there is an address beside lo's
ip addr add 10.9.9.1/24 dev cluster
ip link set cluster up
mount -t tmpfs none /run
(umask 077 && head -c 256 /dev/urandom >"$folder/munge/key")
/usr/sbin/munged --force --key-file="$folder/munge/key" --socket="$folder/munge/socket" --pid-file="$folder/munge/pid" \
  --log-file="$folder/munge/log" --seed-file="$folder/munge/seed"
cat >"$folder/slurm.conf" <<CONF
ClusterName=gridspace
SlurmctldHost=$(hostname)(10.9.9.1)
SlurmctldPort=16817
AuthType=auth/munge
AuthInfo=socket=$folder/munge/socket
CredType=cred/munge
SlurmUser=root
SlurmdUser=root
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/%n
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/%n.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
SlurmdTimeout=5
KillWait=2
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=sched_interval=1,batch_sched_delay=0
NodeName=n1 NodeHostname=$(hostname) NodeAddr=10.9.9.1 Port=17001 CPUs=1 State=UNKNOWN
NodeName=n2 NodeHostname=$(hostname) NodeAddr=10.9.9.1 Port=17002 CPUs=1 State=UNKNOWN
PartitionName=all Nodes=n1,n2 Default=YES MaxTime=INFINITE State=UP
CONF
export SLURM_CONF=$folder/slurm.conf
/usr/sbin/slurmctld -c
/usr/sbin/slurmd -c -N n1
/usr/sbin/slurmd -c -N n2
until [ "$(sinfo --noheader --Node --format=%t 2>/dev/null | grep -c idle)" = 2 ]; do sleep 0.1; done
"$@"
