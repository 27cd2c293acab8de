# SPDX-License-Identifier: MIT
# Shared by the nightly tests that run the program: a data folder of their own with short swallows
# and a thumbnail-sized preset, so that a job takes a second. Needs $program and $source.
set -u
folder=$(mktemp -d "${TMPDIR:-/tmp}/swallowclip-nightly-XXXXXX")
failures=0
tidy() { rm -rf "$folder"; }
trap tidy EXIT
trap 'exit 130' INT TERM

mkdir "$folder/data"
cp -r "$source/scenes" "$source/render_presets" "$source/shaders" "$source/report" "$folder/data/"
export SWALLOWCLIP_DATA=$folder/data
swallows=$folder/data/scenes/swallows
preset=$folder/data/render_presets/tiny.json

# short SCORE SECONDS: the normal swallow cut off, under another score's name
short() {
  printf '{"base": "normal.json", "title": "Short", "component": 4, "score": %s, "duration_s": %s}\n' \
    "$1" "$2" >"$swallows/c04-s$1.json"
}
short 0 0.5
short 1 0.5
sed -e 's/"width_px": 1280/"width_px": 192/' -e 's/"height_px": 720/"height_px": 108/' \
  -e 's/"name": "training"/"name": "tiny"/' "$source/render_presets/training.json" >"$preset"

# spec FILE MISSING_CLIPS_ALLOWED: two scores, two boluses, two views: 26 jobs, 8 clips. A draft,
# since a swallow cut off shows no score.
spec() {
  cat >"$1" <<END
{"spacing_mm": 4, "boluses": ["thin", "honey"], "views": ["oblique", "si"], "presets": ["tiny"],
 "sheet": {"columns": 2, "rows": 2, "width_px": 96},
 "swallows": [{"component": 4, "scores": [0, 1]}],
 "publish": {"labels": "any", "missing_clips_allowed": $2}}
END
}
spec "$folder/spec.json" 0

fail() {
  echo "FAILED: $*"
  failures=$((failures + 1))
}

# field NAME: out of the last summary
field() { sed -n "s/.*\"$1\": \"\{0,1\}\([^,\"}]*\).*/\1/p" "$folder/summary"; }

# night LIBRARY OPTIONS...: one night; its summary is kept for field
night() {
  local out=$1
  shift
  "$program" nightly --spec "$folder/spec.json" --out "$out" --jobs 2 "$@" \
    >"$folder/summary" 2>"$folder/errors"
}

# key JOB: of the plan as things are now
key() {
  "$program" nightly --spec "$folder/spec.json" --out "$library" --plan |
    sed -n "s|^\([0-9a-f]*\)  $1  <-.*|\1|p"
}

# product JOB FILE: where it is kept
product() { echo "$library"/store/*/"$(key "$1")/$2"; }

# whole LIBRARY: is what the link shows there, complete and unharmed at this moment?
whole() { (cd -P "$1/current" && sha256sum --quiet -c SHA256SUMS) >/dev/null 2>&1; }

# same A B: do two libraries show the same bytes? (manifests carry the name of their night)
same() {
  grep -v ' manifest.json$' "$1/current/SHA256SUMS" >"$folder/a.sums"
  grep -v ' manifest.json$' "$2/current/SHA256SUMS" >"$folder/b.sums"
  [ -s "$folder/a.sums" ] && cmp -s "$folder/a.sums" "$folder/b.sums" && whole "$1" && whole "$2"
}

finish() {
  [ "$failures" -eq 0 ] || exit 1
  echo "passed"
}
