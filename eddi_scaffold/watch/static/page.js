"use strict";
// The page is complete without this; with it, an event brings a newer one, and what differs is taken.
const by = (id) => document.getElementById(id);
const numberOf = (item) => Number(item?.dataset.number ?? 0);
let announced = numberOf(by("changes").firstElementChild);

function update(shown, fresh) {
  if (shown.isEqualNode(fresh)) return;
  if (shown.nodeType !== Node.ELEMENT_NODE || shown.nodeName !== fresh.nodeName || shown.id !== fresh.id) {
    shown.replaceWith(fresh);
    return;
  }
  for (const { name, value } of fresh.attributes) {
    const isNew = name !== "open" && shown.getAttribute(name) !== value; // a person opens and closes
    if (isNew) shown.setAttribute(name, value);
  }
  const children = [...fresh.childNodes];
  while (shown.childNodes.length > children.length) shown.lastChild.remove();
  children.forEach((child, index) => {
    if (index < shown.childNodes.length) update(shown.childNodes[index], child);
    else shown.append(child);
  });
}

function announce() {
  const items = [...by("changes").children].filter((item) => numberOf(item) > announced);
  if (items.length === 0) return;
  announced = numberOf(items[0]);
  const texts = items.map((item) => item.textContent);
  const many = `${texts.length} changes, the last: ${texts[0]}`;
  by("announced").textContent = texts.length > 3 ? many : texts.reverse().join(". ");
}

const events = new EventSource("/events");
events.addEventListener("message", (event) => {
  const fresh = new DOMParser().parseFromString(JSON.parse(event.data), "text/html");
  update(document.querySelector("main"), fresh.querySelector("main"));
  announce();
});
events.addEventListener("error", () => {
  by("link").textContent = "Not connected: what you see may be old.";
  document.querySelector("main").classList.add("old");
});
events.addEventListener("open", () => document.querySelector("main").classList.remove("old"));
