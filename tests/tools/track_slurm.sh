#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# A catalog of films with a Slurm of its own: slurmctld, slurmd and munged on this machine. There are more films than an array may
# have tasks, one of them is damaged, and another one comes after the job was submitted.
# shellcheck source=common.sh
. "$(dirname "$0")/common.sh"
PATH=$(dirname "$PLAY"):$PATH:/usr/sbin
catalogue=$here/../../pipelines/author-catalogue.sh

stop() {
  local file id
  for file in slurmd ctld munged; do
    [ -s "$work/$file.pid" ] || continue
    id=$(cat "$work/$file.pid")
    # It saves its state at its end.
    # shellcheck disable=SC2016 # of the inner shell
    timeout 10 bash -c 'kill "$0" && while kill -0 "$0"; do sleep 0.05; done' "$id" 2>/dev/null || true
  done
  rm -rf "$work"
}
trap stop EXIT

# Two ports that nobody listens at.
read -r controller_port daemon_port < <("$PYTHON" -c '
import socket
sockets = [socket.create_server(("127.0.0.1", 0)) for _ in range(2)]
print(*(one.getsockname()[1] for one in sockets))')
host=$(hostname -s)
user=$(id -un)
mkdir state spool
head -c 1024 /dev/urandom >munge.key
chmod 600 munge.key
chmod 755 "$work"
munged --force --key-file="$work/munge.key" --socket="$work/munge.socket" --pid-file="$work/munged.pid" --log-file="$work/munged.log" \
  --seed-file="$work/munged.seed" >munged.out 2>&1 || fail "$(cat munged.out)"
cat >slurm.conf <<END
ClusterName=test
SlurmctldHost=$host(127.0.0.1)
SlurmUser=$user
SlurmdUser=$user
AuthInfo=socket=$work/munge.socket
SlurmctldPort=$controller_port
SlurmdPort=$daemon_port
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/ctld.pid
SlurmdPidFile=$work/slurmd.pid
SlurmctldLogFile=$work/ctld.log
SlurmdLogFile=$work/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
MaxArraySize=3
SchedulerParameters=sched_interval=1,batch_sched_delay=0
NodeName=$host NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES State=UP
END
export SLURM_CONF=$work/slurm.conf
{ slurmctld -c && slurmd -c -b; } || fail "$(cat ./*.log)"
for ((i = 0; i < 600; i++)); do
  [ -z "$(sinfo --noheader --states=idle --format=%N 2>/dev/null)" ] || break
  sleep 0.1
done
[ "$i" -lt 600 ] || fail "no idle node: $(cat ./*.log)"

mkdir films
for i in 1 2 3 4; do
  film "films/$i.mkv" "$(picture 160 120 I420 60) ! $h264 ! matroskamux"
done
echo "This is no film." >films/5.mp4

# The first task that runs brings another film, before the others read the list.
cat >tactile-track <<END
#!/bin/sh
cp "$work/films/1.mkv" "$work/films/0.mkv" 2>/dev/null
exec "$(dirname "$PLAY")/tactile-track" "\$@"
END
chmod +x tactile-track
PATH=$work:$PATH
status=0
"$catalogue" --slurm films tracks >out 2>err || status=$?
expect_status 1
for i in 1 2 3 4; do
  expect_line out "^$i\.mkv +2\.000 +[0-9]+ %\$"
done
expect_line out '^5\.mp4 +no track: .+'
expect_line out '^1 without a track$'
[ "$(grep -h -c '5.mp4' tracks/slurm-*.log | sort -n | tail -n 1)" -ge 2 ] || fail "5.mp4 was not tried twice"
[ ! -e tracks/0.mkv.vtt ] || fail "a film that came later was analyzed"

# Resumed, the run has the same films; a new one has all.
status=0
"$catalogue" --slurm --resume films tracks >out 2>err || status=$?
expect_status 1
! grep -q '^0\.mkv' out || fail "$(cat out)"
rm films/5.mp4
"$catalogue" --slurm films tracks >out 2>err || fail "$(cat out err)"
expect_line out '^0\.mkv +2\.000'
expect_line out '^0 without a track$'
echo "a catalogue of 6 films with Slurm: passed"
