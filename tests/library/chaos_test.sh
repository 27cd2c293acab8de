#!/bin/bash
# SPDX-License-Identifier: MIT
# Kills, a full disk, damage and a job that always crashes; the link never shows a broken night.
# Usage: chaos_test.sh PROGRAM SOURCE_FOLDER [ROUNDS]
program=$1 source=$2 rounds=${3:-20}
. "$source/tests/library/common.sh"
library=$folder/library

# Looks at what is shown, from the first night on, all the time, until told to stop.
(
  until [ -L "$library/current" ] || [ -e "$folder/stop" ]; do sleep 0.05; done
  while [ ! -e "$folder/stop" ]; do
    whole "$library" || readlink "$library/current" >>"$folder/broken" || echo 'no link' >>"$folder/broken"
    sleep 0.05
  done
) &
watcher=$!

night "$folder/reference" || fail "the undisturbed night: $(cat "$folder/errors")"

# 1. kill -9 of the whole process group at random moments, each time with work to do and a night
# shown. One undisturbed round tells how long a round takes.
# (In front: the end of a title doesn't fit into so small a picture.)
retitle() { sed -i "s/\"[^\"]*S-I tongue view\"/\"$1S-I tongue view\"/" "$preset"; }
night "$library" || fail "a first night: $(cat "$folder/errors")"
retitle 'warm '
start=$(date +%s%N)
night "$library" || fail "a second night: $(cat "$folder/errors")"
round_ms=$((($(date +%s%N) - start) / 1000000))
RANDOM=4711
finished=0
for round in $(seq "$rounds"); do
  retitle "$round "
  setsid "$program" nightly --spec "$folder/spec.json" --out "$library" --jobs 2 \
    >"$folder/summary" 2>"$folder/errors" &
  group=$!
  wait_ms=$((RANDOM * round_ms / 32768))
  sleep "$((wait_ms / 1000)).$(printf %03d $((wait_ms % 1000)))"
  kill -9 -- "-$group" 2>/dev/null || finished=$((finished + 1))
  wait "$group" 2>/dev/null
  # Nothing of it may go on: the lock is free as soon as the last of them is gone.
  timeout 20 flock "$library/lock" true 2>/dev/null || fail "round $round: jobs outlive their night"
done
echo "$rounds rounds of up to $round_ms ms, $finished had finished before the kill"

# 2. Damage by hand.
night "$library" || fail "after the kills: $(cat "$folder/errors")"
history=$(product 'simulate c04-s0-thin' history.h5)
printf 'garbage' | dd of="$history" bs=1 seek=3000 conv=notrunc 2>/dev/null
truncate -s 100 "$(product 'draw tiny/c04/c04-s1-honey-oblique' c04-s1-honey-oblique.mp4)"
retitle ''
night "$library" || fail "after the damage: $(cat "$folder/errors")"
[ "$(field run)" = 2 ] || fail "after the damage: $(field run) jobs instead of 2"
same "$library" "$folder/reference" || fail 'not the bytes of an undisturbed night'

# 3. A job that always crashes: setpriv starts every job, so a false one can poison it.
short 1 0.55
night "$folder/reference" || fail 'the undisturbed night with another swallow'
key=$(key 'simulate c04-s1-honey')
mkdir "$folder/bin"
cat >"$folder/bin/setpriv" <<END
#!/bin/sh
case "\$*" in *" job $key "*) kill -SEGV \$\$ ;; esac
exec $(command -v setpriv) "\$@"
END
chmod +x "$folder/bin/setpriv"
before=$(readlink "$library/current")
PATH=$folder/bin:$PATH night "$library" && fail 'a night with a poisoned job succeeded'
[ "$(field outcome)" = kept ] && [ "$(field missing)" = 2 ] || fail "poisoned: $(cat "$folder/summary")"
[ "$(readlink "$library/current")" = "$before" ] || fail 'a night with gaps was shown'
grep -q 'simulate c04-s1-honey' "$library/report/index.html" || fail 'the report names no culprit'
grep -q "swallowclip job $key" "$library/report/index.html" || fail 'the report lacks the replay'
# The policy may allow gaps: then the rest is shown, and the manifest lists what is missing.
spec "$folder/spec.json" 2
PATH=$folder/bin:$PATH night "$library" || fail "gaps allowed: $(cat "$folder/errors")"
[ "$(field outcome)" = published ] && [ "$(field clips)" = 6 ] || fail "gaps: $(cat "$folder/summary")"
grep -q 'simulate c04-s1-honey failed' "$library/current/manifest.json" || fail 'no list of gaps'
grep -v ' manifest.json$\|c04-s1-honey' "$folder/reference/current/SHA256SUMS" >"$folder/a.sums"
grep -v ' manifest.json$' "$library/current/SHA256SUMS" | cmp -s - "$folder/a.sums" ||
  fail 'the rest is not what it should be'
spec "$folder/spec.json" 0
night "$library" || fail 'the last clean night'
same "$library" "$folder/reference" || fail 'after the poison: not the bytes of an undisturbed night'

# 4. A full disk, where a small file system can be mounted. Ballast leaves so many megabytes of it.
disk=$folder/disk
leave() { fallocate -l $(($(df --output=avail -B1 "$disk" | tail -1) - $1 * 1048576)) "$disk/ballast"; }
mkdir "$disk"
truncate -s 100M "$folder/disk.image" && mkfs.ext4 -q -m 0 "$folder/disk.image"
if mount -o loop "$folder/disk.image" "$disk" 2>/dev/null; then
  trap 'umount "$disk"; tidy' EXIT
  rmdir "$disk/lost+found"
  leave 6
  night "$disk/library" && fail 'a night on a full disk succeeded'
  grep -q 'No space left' "$folder/errors" "$disk"/library/run/logs/* || fail 'no word of the full disk'
  [ ! -e "$disk/library/current" ] || fail 'a night on a full disk was shown'
  rm "$disk/ballast"
  night "$disk/library" || fail "with space again: $(cat "$folder/errors")"
  same "$disk/library" "$folder/reference" || fail 'full disk: other bytes'
  # Shown, then full: the last night stays.
  short 0 0.55
  leave 1
  night "$disk/library" && fail 'a second night on a full disk succeeded'
  same "$disk/library" "$folder/reference" || fail 'the full disk has changed what is shown'
  umount "$disk"
  trap tidy EXIT
else
  echo 'skipped: the full disk (mounting a small file system needs root)'
fi

touch "$folder/stop"
wait "$watcher"
[ ! -e "$folder/broken" ] || fail "the link showed a broken night: $(sort "$folder/broken" | uniq -c)"
finish
