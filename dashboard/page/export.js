// Exports charts as files without the server.

import {el} from "./dom.js";

const LOOKS = [
  "fill", "stroke", "stroke-width", "stroke-dasharray", "opacity", "font-family", "font-size",
  "font-weight", "text-anchor"
];

/**
 * An SVG file that does not need the page: the style sheets' values become attributes. It uses the
 * light theme on a white background.
 */
export function standaloneSvg(svg) {
  const root = document.documentElement;
  const theme = root.dataset.theme;
  root.dataset.theme = "light";
  const copy = svg.cloneNode(true);
  const originals = [svg, ...svg.querySelectorAll("*")];
  [copy, ...copy.querySelectorAll("*")].forEach((element, number) => {
    const style = getComputedStyle(originals[number]);
    for (const look of LOOKS) element.setAttribute(look, style.getPropertyValue(look));
    element.removeAttribute("class");
    element.removeAttribute("style");  // those that d3 sets are among LOOKS
  });
  if (theme === undefined)
    delete root.dataset.theme;
  else
    root.dataset.theme = theme;
  const [width, height] = [svg.getAttribute("width"), svg.getAttribute("height")];
  copy.setAttribute("xmlns", "http://www.w3.org/2000/svg");
  copy.setAttribute("viewBox", `0 0 ${width} ${height}`);
  const ground = document.createElementNS("http://www.w3.org/2000/svg", "rect");
  for (const [name, value] of [["width", width], ["height", height], ["fill", "white"]])
    ground.setAttribute(name, value);
  copy.prepend(ground);
  return `<?xml version="1.0" encoding="UTF-8"?>\n${new XMLSerializer().serializeToString(copy)}\n`;
}

/**
 * @param table {columns: [name with unit], rows: [[value]]}; unknown values become empty cells. Names
 *     come from the lab: a text that a spreadsheet would take for a formula gets a ' before it.
 */
export function csvText(table) {
  const cell = (value) => {
    if (value === null || value === undefined || Number.isNaN(value)) return "";
    const formula = typeof value === "string" && /^[=+\-@\t\r]/.test(value);
    const text = formula ? `'${value}` : String(value);
    return /[",\n\r]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
  };
  return [table.columns, ...table.rows].map((row) => row.map(cell).join(",")).join("\n") + "\n";
}

export function download(name, text, type) {
  const address = URL.createObjectURL(new Blob([text], {type}));
  const link = el("a", {href: address, download: name.replace(/[^\w.-]+/g, "_")});
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(address), 10000);
}
