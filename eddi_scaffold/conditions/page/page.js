"use strict";
// Everything here is a convenience: the page works without it.
const text = document.getElementById("text");

// The caret goes to the first error. Offsets count characters, the browser counts UTF-16 units.
if (text.dataset.at !== undefined) {
  const at = Array.from(text.value).slice(0, Number(text.dataset.at)).join("").length;
  text.focus();
  text.setSelectionRange(at, Math.min(at + 1, text.value.length));
}

document.addEventListener("keydown", (event) => {
  if (event.key === "Enter" && (event.ctrlKey || event.metaKey)) {
    event.preventDefault();
    document.getElementById("check").click();
  }
});

for (const button of document.querySelectorAll(".copy")) {
  button.hidden = false;
  button.addEventListener("click", async () => {
    const code = document.getElementById(button.dataset.copies);
    code.select();
    try {
      await navigator.clipboard.writeText(code.value);
      button.textContent = "Copied";
    } catch {
      button.textContent = "Press Ctrl+C";
    }
  });
}
