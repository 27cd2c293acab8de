#!/bin/bash
# SPDX-License-Identifier: MIT
# A night through a real Slurm: two nodes on loopback, one killed in the middle, one job requeued;
# the same bytes as with Ninja. Exit code 77 (skipped) where it can't be root.
# Usage: slurm_test.sh PROGRAM SOURCE_FOLDER
program=$1 source=$2
if [ "$(id -u)" -ne 0 ]; then
  echo 'skipped: Slurm and munge are installed and started as root only'
  exit 77
fi
if ! command -v slurmctld slurmd munged sbatch >/dev/null; then
  # Without this Debian would start the daemons with settings of their own.
  [ -e /usr/sbin/policy-rc.d ] || { made_policy=1 && printf '#!/bin/sh\nexit 101\n' >/usr/sbin/policy-rc.d &&
    chmod +x /usr/sbin/policy-rc.d; }
  (apt-get update -q && DEBIAN_FRONTEND=noninteractive apt-get install -y -q \
    --no-install-recommends slurm-wlm munge) >/dev/null 2>&1
  [ -z "${made_policy:-}" ] || rm /usr/sbin/policy-rc.d
fi
if ! command -v slurmctld slurmd munged sbatch >/dev/null; then
  echo 'skipped: slurm-wlm and munge could not be installed'
  exit 77
fi
. "$source/tests/library/common.sh"
slurm=$folder/slurm
mkdir "$slurm" "$slurm/state" "$slurm/n1" "$slurm/n2"
chmod 755 "$folder" "$slurm"

# A munge of its own, so that one of the machine is left alone.
mkdir "$slurm/munge"
dd if=/dev/urandom of="$slurm/munge/key" bs=1024 count=1 2>/dev/null
chmod 600 "$slurm/munge/key"
chown -R munge "$slurm/munge"
chmod 755 "$slurm/munge"
pids=
stop() {
  for pid in $pids; do kill "$pid" 2>/dev/null; done
  sleep 1
  for pid in $pids; do kill -9 "$pid" 2>/dev/null; done
  [ -z "${SLURM_TEST_KEEP:-}" ] || cp -r "$folder" "$SLURM_TEST_KEEP"
  tidy
}
trap stop EXIT
setpriv --reuid munge --regid munge --clear-groups munged --foreground \
  --key-file="$slurm/munge/key" --socket="$slurm/munge/socket" --pid-file="$slurm/munge/pid" \
  --log-file="$slurm/munge/log" --seed-file="$slurm/munge/seed" >"$slurm/munge.out" 2>&1 &
pids="$pids $!"

cat >"$slurm/slurm.conf" <<END
ClusterName=swallowclip
SlurmctldHost=$(hostname -s)(127.0.0.1)
SlurmctldPort=16817
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$slurm/munge/socket
CredType=cred/munge
CommunicationParameters=NoCtldInAddrAny,NoInAddrAny
StateSaveLocation=$slurm/state
SlurmctldPidFile=$slurm/ctld.pid
SlurmctldLogFile=$slurm/ctld.log
SlurmdPidFile=$slurm/%n/pid
SlurmdSpoolDir=$slurm/%n
SlurmdLogFile=$slurm/%n.log
SlurmdParameters=config_overrides
SlurmdTimeout=20
ReturnToService=2
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
AccountingStorageType=accounting_storage/none
JobCompType=jobcomp/filetxt
JobCompLoc=$slurm/completed
SelectType=select/cons_tres
SchedulerParameters=batch_sched_delay=0,sched_min_interval=0
NodeName=n1 NodeHostname=$(hostname -s) NodeAddr=127.0.0.1 Port=17001 CPUs=1 RealMemory=1000
NodeName=n2 NodeHostname=$(hostname -s) NodeAddr=127.0.0.1 Port=17002 CPUs=1 RealMemory=1000
PartitionName=night Nodes=n1,n2 Default=YES State=UP
END
export SLURM_CONF=$slurm/slurm.conf
slurmctld -D >"$slurm/ctld.out" 2>&1 &
pids="$pids $!"
# A node has processes of its own, so that all of it is gone at once.
start() {
  unshare --pid --fork --kill-child --mount-proc slurmd -D -N "$1" >>"$slurm/$1.out" 2>&1 &
  pids="$pids $!"
}
for node in n1 n2; do
  start $node
done
lost_node=$!
for _ in $(seq 60); do
  [ "$(sinfo --noheader --format=%D --states=idle 2>/dev/null)" = 2 ] && break
  sleep 0.5
done
if [ "$(sinfo --noheader --format=%D --states=idle)" != 2 ]; then
  fail 'the two nodes did not come up'
  tail -5 "$slurm"/*.log "$slurm"/*.out
  finish
fi

# wait_for COMMAND: up to two minutes
wait_for() {
  for _ in $(seq 240); do
    eval "$1" && return 0
    sleep 0.5
  done
  return 1
}

library=$folder/library
night "$library" --engine slurm &
waiting=$!
# tasks NODE: running there
tasks() { squeue --noheader --states=running --nodelist="$1" --format=%i | grep _ | head -1; }
restarted() { scontrol show job "$1" | grep -q 'Restarts=1'; }
wait_for '[ -n "$(tasks n1)" ] && [ -n "$(tasks n2)" ]' || fail 'no task on each node'
"$program" nightly --spec "$folder/spec.json" --out "$library" --engine slurm 2>"$folder/second" &&
  fail 'a second night was let in'
grep -q "another night is in Slurm's queue" "$folder/second" || fail "second: $(cat "$folder/second")"
# One task back into the queue, and one node gone with its task.
wait_for '[ -n "$(tasks n1)" ] && [ -n "$(tasks n2)" ]' || fail 'no task on each node any more'
task=$(tasks n1) lost=$(tasks n2)
kill -9 "$lost_node"
scontrol requeue "$task" || fail "task $task could not be requeued"
restarted "$task" || fail "task $task was not requeued"
wait_for 'sinfo --noheader --format=%T --nodes=n2 | grep -q down' || fail 'the lost node was not noticed'
restarted "$lost" || fail "task $lost of the lost node was not started again"
# It comes back, as after a repair.
start n2
wait "$waiting" || true
# What the lost node left undone is done by the next night.
[ "$(field outcome)" = published ] || {
  echo "after the lost node: $(cat "$folder/summary" "$folder/errors")"
  night "$library" --engine slurm || fail "the next night: $(cat "$folder/summary" "$folder/errors")"
}
night "$folder/reference" || fail "with Ninja: $(cat "$folder/errors")"
same "$library" "$folder/reference" || fail 'Slurm and Ninja give different bytes'
night "$library" --engine slurm || fail 'again'
[ "$(field run)" = 0 ] || fail "again: $(field run) jobs"
finish
