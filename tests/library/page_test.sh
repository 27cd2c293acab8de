#!/bin/bash
# SPDX-License-Identifier: MIT
# The report in a headless Chromium, from file://: no word on the console, pictures load, filters
# work by keyboard events. Exit code 77 (skipped) without Chromium.
# Usage: page_test.sh PROGRAM SOURCE_FOLDER [SCREENSHOT.png]
program=$1 source=$2
browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome) || {
  echo 'skipped: no Chromium (apt-get install chromium)'
  exit 77
}
. "$source/tests/library/common.sh"
library=$folder/library
night "$library" || fail "$(cat "$folder/errors")"
sed -i 's/"S-I tongue view"/"From above"/' "$preset"
sed -i 's/"duration_s": 0.5/"duration_s": 0.55/' "$swallows/c04-s1.json"
night "$library" || fail "$(cat "$folder/errors")"

# The page tests itself: a script at its end types into the filters and writes what it finds into
# the title of the document, which --dump-dom shows.
page=$library/report/test.html
sed 's|</body>||; s|</html>||' "$library/report/index.html" >"$page"
cat >>"$page" <<'END'
<script>
const images = [...document.images];
for (const image of images) image.loading = "eager";
addEventListener("load", () => {
  const result = [];
  const shown = () => document.querySelectorAll(".clips > li:not([hidden])").length;
  const press = (key, target) =>
    target.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true, cancelable: true }));
  result.push("images " + images.filter((i) => i.complete && i.naturalWidth > 0).length + "/" + images.length);
  result.push("all " + shown());
  press("/", document.body);
  const words = document.activeElement;
  result.push("focus " + words.name);
  document.execCommand("insertText", false, "honey si");
  result.push("words " + shown());
  press("Escape", words);
  result.push("escape " + shown());
  const state = document.querySelector("select[name=state]");
  state.focus();
  state.value = "changed";
  state.dispatchEvent(new Event("input", { bubbles: true }));
  result.push("changed " + shown());
  const unnamed = [...document.querySelectorAll("input, select, img")].filter(
    (e) => !(e.alt || (e.labels && e.labels.length)));
  result.push("unnamed " + unnamed.length);
  document.title = result.join("; ");
});
</script></body></html>
END
"$browser" --headless=new --no-sandbox --disable-gpu --user-data-dir="$folder/profile" \
  --enable-logging=stderr --v=0 --virtual-time-budget=20000 --dump-dom "file://$page" \
  >"$folder/dom" 2>"$folder/console"
title=$(sed -n 's|.*<title>\(.*\)</title>.*|\1|p' "$folder/dom")
expected='images 10/10; all 8; focus words; words 2; escape 8; changed 6; unnamed 0'
[ "$title" = "$expected" ] || fail "the page says \"$title\", expected \"$expected\""
if grep 'CONSOLE' "$folder/console"; then fail 'words on the console'; fi
grep -Eq 'src="(http|//)|href="(http|//)' "$library/report/index.html" && fail 'the page needs a network'
if [ -n "${3:-}" ]; then
  "$browser" --headless=new --no-sandbox --disable-gpu --user-data-dir="$folder/profile" \
    --window-size=1280,2200 --hide-scrollbars --virtual-time-budget=8000 --screenshot="$3" \
    "file://$library/report/index.html" 2>/dev/null
fi
finish
