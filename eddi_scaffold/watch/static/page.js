"use strict";
// The page is whole without this; with it, events keep it new. Text of robots is only ever set as text.
const MARKS = {"active": "●", "not active": "✕", "unknown": "?"};
const GRAPH_MS = 1000;
const drawn = new Map();
const by = (id) => document.getElementById(id);

function lines(list, texts) {
  list.replaceChildren(...texts.map((text) => {
    const item = document.createElement("li");
    item.textContent = text;
    return item;
  }));
}

function row(id, [state, why, since]) {
  const found = by(id);
  if (found === null) return;
  const [, , stateCell, whyCell, sinceCell] = found.cells;
  const [mark, word] = stateCell.firstElementChild.children;
  found.dataset.state = state;
  mark.textContent = MARKS[state] ?? "?";
  word.textContent = state;
  whyCell.textContent = why;
  sinceCell.textContent = since;
}

function graph(id, number, version) {
  const picture = document.querySelector(`#${id}-graph img`);
  if (picture === null) return;
  const now = Date.now();
  const wait = (drawn.get(id) ?? 0) + GRAPH_MS - now;
  const source = `/graph/${number}.svg?${version}`;
  picture.dataset.next = source;
  if (wait <= 0) {
    drawn.set(id, now);
    picture.src = source;
  } else {
    setTimeout(() => {
      if (picture.dataset.next === source) picture.src = source;
    }, wait);
  }
}

async function reshape() {
  const text = await (await fetch("/")).text();
  const fresh = new DOMParser().parseFromString(text, "text/html");
  const focused = document.activeElement?.id;
  const closed = new Set([...document.querySelectorAll("details[id]:not([open])")].map((d) => d.id));
  document.querySelector("main").replaceWith(fresh.querySelector("main"));
  for (const id of closed) by(id)?.removeAttribute("open");
  if (focused) by(focused)?.focus();
}

const newest = () => Number(by("changes").firstElementChild?.dataset.number ?? 0);
let told = newest();

function change(list) {
  const shown = newest(); // more than was told, when the page was built anew
  for (const [number, text] of list.filter(([one]) => one > shown).reverse()) {
    const item = document.createElement("li");
    item.dataset.number = number;
    item.textContent = text;
    by("changes").prepend(item);
  }
  while (by("changes").children.length > 50) by("changes").lastElementChild.remove();
  const news = list.filter(([number]) => number > told);
  told = Math.max(told, ...news.map(([number]) => number));
  if (news.length > 3) {
    by("said").textContent = `${news.length} changes, the last: ${news[0][1]}`;
  } else if (news.length > 0) {
    by("said").textContent = [...news].reverse().map(([, text]) => text).join(". ");
  }
}

let pending = Promise.resolve();
async function take(data) {
  if (String(data.shape) !== document.querySelector("main").dataset.shape) await reshape();
  by("time").textContent = data.time;
  lines(by("notes"), data.notes);
  for (const [id, parts] of Object.entries(data.rows)) row(id, parts);
  for (const one of data.groups) {
    const summary = by(`${one.id}-summary`);
    if (summary === null) continue;
    summary.textContent = one.summary;
    lines(by(`${one.id}-facts`), one.facts);
    graph(one.id, one.number, one.graph);
  }
  change(data.changes);
}

const events = new EventSource("/events");
events.addEventListener("message", (event) => {
  by("link").textContent = "Live.";
  const data = JSON.parse(event.data);
  pending = pending.then(() => take(data)).catch(() => {});
});
events.addEventListener("error", () => {
  by("link").textContent = "Not connected: what you see may be old.";
  document.querySelector("main").classList.add("old");
});
events.addEventListener("open", () => document.querySelector("main").classList.remove("old"));
