#!/bin/bash
# SPDX-License-Identifier: MIT
# A night from nothing, again, and after one change at a time: exactly the expected jobs are run.
# Usage: count_test.sh PROGRAM SOURCE_FOLDER
program=$1 source=$2
. "$source/tests/library/common.sh"
library=$folder/library

# expect RUN OUTCOME WHAT
expect() {
  night "$library"
  if [ "$(field run)" != "$1" ] || [ "$(field outcome)" != "$2" ]; then
    fail "$3: $(field run) jobs, $(field outcome); expected $1 jobs, $2"
    cat "$folder/summary" "$folder/errors"
  fi
}

[ "$("$program" nightly --spec "$folder/spec.json" --out "$library" --plan | tail -1 |
  cut -d, -f1)" = '8 clips; 26 of 26 jobs to do' ] || fail '--plan counts other jobs'
[ ! -e "$library" ] || fail '--plan has made the folder'

expect 26 published 'from nothing'
start=$(date +%s%N)
expect 0 unchanged 'again'
took_ms=$((($(date +%s%N) - start) / 1000000))
[ "$took_ms" -lt 3000 ] || fail "a night without jobs took $took_ms ms"

echo 'words' >"$folder/data/scenes/README.md"
sed -i '1s/{/{"comment": "another remark",/' "$swallows/c04-s0.json"
sed -i 's|"boluses": {|"boluses": {"mine": {"density_kgm3": 1000, "rheology": "newtonian", "viscosity_Pas": 1},|' \
  "$folder/data/scenes/boluses.json"
expect 0 unchanged 'remarks and a bolus that nobody uses'

sed -i 's/"S-I tongue view"/"From above"/' "$preset"
"$program" nightly --spec "$folder/spec.json" --out "$library" --plan >"$folder/plan"
[ "$(grep -c 'stale: file tiny.json si changed' "$folder/plan")" = 4 ] || fail '--plan says no why'
expect 8 published 'one view of a preset: 4 draws, 4 verifications'

short 1 0.6
expect 13 published 'one score file: 1 bake, 2 of simulate and measure, 4 of draw and verify'

sed -i 's/"viscosity_Pas": 0.004/"viscosity_Pas": 0.005/' "$folder/data/scenes/boluses.json"
expect 12 published 'one bolus: 2 of simulate and measure, 4 of draw and verify'

short 1 0.5
sed -i 's/"viscosity_Pas": 0.005/"viscosity_Pas": 0.004/' "$folder/data/scenes/boluses.json"
sed -i 's/"From above"/"S-I tongue view"/' "$preset"
expect 0 published 'everything as it was: all products are still there'

history=$(product 'simulate c04-s0-thin' history.h5)
printf 'x' | dd of="$history" bs=1 seek=5000 conv=notrunc 2>/dev/null
before=$(readlink "$library/current")
expect 1 unchanged 'one damaged history'
[ "$(readlink "$library/current")" = "$before" ] || fail 'the link has moved without need'

printf 'x' | dd of="$library/current/tiny/c04/c04-s0-thin-si.mp4" bs=1 seek=500 conv=notrunc 2>/dev/null
expect 0 published 'one damaged clip of the night shown'
whole "$library" || fail 'the new night is not whole'
printf 'x' >>"$library/current/manifest.json"
expect 0 published 'a damaged manifest'
rm "$library/current"
expect 0 published 'no link'

# Mistakes of all kinds
sed -i 's/"thin"/"thn"/; s/"oblique"/"obliqe"/' "$folder/spec.json"
night "$library" && fail 'a wrong spec was taken'
for text in 'Did you mean "thin"' 'Did you mean "oblique"' 'spec.json:1:'; do
  grep -qF "$text" "$folder/errors" || fail "spec errors lack $text"
done
spec "$folder/spec.json" 0
night "$library" --engine cluster && fail 'an unknown engine was taken'
grep -qF 'Known: local, slurm' "$folder/errors" || fail 'no engines are offered'
mkdir "$folder/bin"
for tool in env setpriv; do ln -s "$(command -v $tool)" "$folder/bin/"; done
PATH=$folder/bin night "$library" && fail 'a night without Ninja'
/bin/grep -qF 'apt-get install ninja-build' "$folder/errors" || fail 'Ninja: no word on what to install'
PATH=$folder/bin night "$library" --engine slurm && fail 'a night without Slurm'
/bin/grep -qF 'apt-get install slurm-wlm' "$folder/errors" || fail 'Slurm: no word on what to install'
"$program" job 00000000000000000000000000000000 --out "$library" 2>"$folder/errors" &&
  fail 'a job that is in no plan'
grep -qF 'nightly --plan' "$folder/errors" || fail 'no hint at the plan'
whole "$library" || fail 'the mistakes have harmed the library'
finish
