// Helpers for the document. Text from the lab is not trusted: it is only set as text, never as
// HTML.

export const find = (id) => document.getElementById(id);

/** Creates an element. `text` sets its text, `on: {event: call}` adds listeners. */
export function el(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (name === "text")
      made.textContent = value;
    else if (name === "on")
      for (const [event, call] of Object.entries(value)) made.addEventListener(event, call);
    else
      made.setAttribute(name, value === true ? "" : value);
  }
  made.append(...children.filter((child) => child !== null));
  return made;
}

/**
 * Sets a text only if it differs. Otherwise screen readers would read it again, and a selection
 * would be lost.
 */
export function setText(element, text, className) {
  if (element.textContent !== text) element.textContent = text;
  if (className !== undefined && element.className !== className) element.className = className;
}

/**
 * Fills a table in place.
 * @param columns [{head, right, text: row => string, fill: (cell, row) => void, kind: row =>
 *     class}]
 */
export function fillTable(table, columns, rows) {
  const heads = columns.map((column) => column.head).join("\n");
  if (table.heads !== heads) {
    table.heads = heads;
    const row = el(
        "tr", {},
        ...columns.map((c) => el("th", {text: c.head, scope: "col", class: c.right && "right"})));
    table.replaceChildren(el("thead", {}, row), el("tbody"));
  }
  const body = table.tBodies[0];
  while (body.rows.length > rows.length) body.deleteRow(-1);
  rows.forEach((row, number) => {
    let line = body.rows[number];
    if (!line) {
      line = body.insertRow();
      for (const column of columns) line.append(el("td", {class: column.right && "right"}));
    }
    columns.forEach((column, place) => {
      const cell = line.cells[place];
      if (column.fill)
        column.fill(cell, row);
      else
        setText(
            cell, column.text(row),
            `${column.right ? "right " : ""}${column.kind?.(row) ?? ""}`.trim());
    });
  });
  table.hidden = rows.length === 0;
}

/** Fills a <dl> with [[name, text, class], ...] in place. */
export function fillFacts(list, facts) {
  while (list.children.length > 2 * facts.length) list.lastChild.remove();
  while (list.children.length < 2 * facts.length) list.append(el("dt"), el("dd"));
  facts.forEach(([name, text, kind = ""], number) => {
    setText(list.children[2 * number], name);
    setText(list.children[2 * number + 1], text, kind);
  });
}

/** Fills a <select> with [[value, text], ...] and keeps the selection if it still exists. */
export function fillSelect(select, options) {
  const key = JSON.stringify(options);
  if (select.key === key) return;
  select.key = key;
  const chosen = select.value;
  select.replaceChildren(...options.map(([value, text]) => el("option", {value, text})));
  if (options.some(([value]) => value === chosen)) select.value = chosen;
}

/**
 * @return a function that schedules `draw` for the next frame, or for when the element becomes
 *     visible. Several calls draw once, and `draw` runs at most once per `period` [ms].
 */
export function drawWhenSeen(element, draw, period = 0) {
  let dirty = false;
  let seen = false;
  let scheduled = false;
  let next = 0;
  const later = () => {
    if (!dirty || !seen || scheduled) return;
    scheduled = true;
    setTimeout(
        () => requestAnimationFrame(() => {
          scheduled = false;
          dirty = false;
          next = performance.now() + period;
          draw();
        }),
        Math.max(0, next - performance.now()));
  };
  new IntersectionObserver((entries) => {
    seen = entries[entries.length - 1].isIntersecting;
    later();
  }, {rootMargin: "100px"}).observe(element);
  return () => {
    dirty = true;
    later();
  };
}

/**
 * Calls `work` every `period` ms while the element is visible and the previous call has finished.
 */
export function pollWhileSeen(element, period, work) {
  let seen = false;
  let busy = false;
  new IntersectionObserver((entries) => {
    seen = entries[entries.length - 1].isIntersecting;
  }).observe(element);
  setInterval(async () => {
    if (!seen || busy || document.hidden) return;
    busy = true;
    try {
      await work();
    } finally {
      busy = false;
    }
  }, period);
}

/** Puts a button into `place` (replacing its content) that acts only after a confirmation. */
export function confirmButton(place, text, question, yes, act) {
  const first = el("button", {type: "button", text});
  const ask = el("span", {class: "row", hidden: true});
  const open = (asking) => {
    first.hidden = asking;
    ask.hidden = !asking;
    (asking ? ask.querySelector("button:last-of-type") : first).focus();
  };
  ask.append(
      el("span", {text: question}), el("button", {
        type: "button",
        text: yes,
        on: {
          click: () => {
            open(false);
            act();
          }
        }
      }),
      el("button", {type: "button", text: "no", on: {click: () => open(false)}}));
  first.addEventListener("click", () => open(true));
  place.replaceChildren(first, ask);
  return first;
}
