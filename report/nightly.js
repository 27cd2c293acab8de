// SPDX-License-Identifier: MIT
// Filters of the nightly report: all of them ordinary form fields; "/" jumps to the first, Escape
// clears them.
"use strict";
(() => {
  const fields = [...document.querySelectorAll(".filters [name]")];
  const clips = [...document.querySelectorAll(".clips > li")];
  const count = document.getElementById("count");
  if (!fields.length) return;
  const show = () => {
    let shown = 0;
    for (const clip of clips) {
      const match = fields.every(({ name, value }) =>
        name === "words"
          ? value.toLowerCase().split(/\s+/).every((word) => clip.dataset.words.includes(word))
          : !value || clip.dataset[name] === value);
      clip.hidden = !match;
      shown += match;
    }
    count.textContent = `${shown} of ${clips.length} clips`;
  };
  for (const field of fields) field.addEventListener("input", show);
  document.addEventListener("keydown", (event) => {
    const typing = event.target.matches("input, select");
    if (event.key === "/" && !typing) {
      event.preventDefault();
      fields[0].focus();
    } else if (event.key === "Escape") {
      for (const field of fields) field.value = "";
      show();
    }
  });
  show();
})();
