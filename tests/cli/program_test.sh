#!/bin/sh
# SPDX-License-Identifier: MIT
# The program as a person meets it: exit codes, and which stream speaks.
# Usage: program_test.sh PROGRAM
set -u
program=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failures=0

# expect CODE STREAM TEXT ARGUMENTS...: the exit code, and a text on stdout or stderr
expect() {
  code=$1 stream=$2 text=$3
  shift 3
  "$program" "$@" >"$folder/out" 2>"$folder/err" </dev/null
  found=$?
  if [ "$found" -ne "$code" ]; then
    echo "swallowclip $*: exit code $found, expected $code"
    failures=$((failures + 1))
  fi
  if ! grep -qF -- "$text" "$folder/$stream"; then
    echo "swallowclip $*: std$stream lacks \"$text\", it holds:"
    cat "$folder/$stream"
    failures=$((failures + 1))
  fi
}

expect 0 out 'render' --help
expect 0 out 'swallowclip ' --version
expect 0 out '--component' render --help
expect 2 err 'A subcommand is required'
expect 2 err 'Did you mean "render"?' rendr
expect 2 err 'Did you mean --score?' render --component 4 --scroe 1
expect 2 err 'Did you mean "nectar"?' render --component 4 --score 1 --bolus nectra
expect 2 err 'Did you mean "lateral"?' render --component 4 --score 1 --views latral
expect 2 err 'Its scores are 0 to 2.' render --component 10 --score 4
expect 2 err 'no such file' measure "$folder/none.h5"
expect 2 err 'no such file' verify "$folder/none.json"
expect 2 err 'Did you mean "short"?' verify --subset shrt
expect 0 out 'thesis-honey' list boluses
expect 0 out 'oblique' list views

printf '{"name": "x", "views": {}, "fsp": 30}' >"$folder/preset.json"
expect 2 err 'preset.json:1:' check "$folder/preset.json"

printf '{"name": "k", "type": "kernels", "tolerance": 1e-4}' >"$folder/k.json"
expect 0 out '1 of 1 cases passed' verify "$folder/k.json" --out "$folder/verify"
printf '{"name": "k", "type": "kernels", "tolerance": 1e-12}' >"$folder/k.json"
expect 1 out 'FAIL' verify "$folder/k.json" --out "$folder/verify"
expect 2 err 'from 0.2 to 10' verify "$folder/k.json" --spacing-mm 99
printf '{"name": "k", "type": "kernels", "tolerance": -1}' >"$folder/k.json"
expect 2 err 'k.json:1:' verify "$folder/k.json" --out "$folder/verify"

# A result that cannot be written is a failure, not a success.
if [ -w /dev/full ]; then
  "$program" --help >/dev/full 2>/dev/null
  if [ $? -ne 1 ]; then
    echo "swallowclip --help >/dev/full: expected exit code 1"
    failures=$((failures + 1))
  fi
fi
[ "$failures" -eq 0 ]
