// Keyboard shortcuts. The space bar is only the emergency stop; buttons are pressed with Enter.

import {find} from "./dom.js";

const TEXT = new Set(["text", "search", "url", "email", "password", "number", "tel"]);

function typing(target) {
  return target instanceof HTMLTextAreaElement || target?.isContentEditable ||
      (target instanceof HTMLInputElement && TEXT.has(target.type));
}

export function listenToKeys(view, controls) {
  // In the capture phase, and for both events: depending on the browser, one of them presses the
  // focused button.
  for (const edge of ["keydown", "keyup"]) {
    addEventListener(edge, (event) => {
      if (event.key !== " " || typing(event.target) || event.ctrlKey || event.altKey ||
          event.metaKey)
        return;
      event.preventDefault();
      event.stopPropagation();
      if (edge === "keydown" && !event.repeat) controls.stop("space bar on the page");
    }, {capture: true});
  }

  addEventListener("keydown", (event) => {
    const {target, key} = event;
    if (typing(target)) {
      if (key === "Escape") target.blur();
      return;
    }
    if (key === "Enter" && target instanceof HTMLInputElement && target.type === "checkbox") {
      event.preventDefault();  // usually the space bar toggles it
      target.click();
      return;
    }
    if (event.ctrlKey || event.altKey || event.metaKey || target instanceof HTMLSelectElement)
      return;
    const act = {
      f: () => view.follow(!view.following),
      "+": () => view.zoomBy(1.5),
      "=": () => view.zoomBy(1.5),
      "-": () => view.zoomBy(1 / 1.5),
      0: () => view.reset(),
      "?": () => find("help").open || find("help").showModal(),
    }[key];
    if (!act) return;
    event.preventDefault();
    act();
  });
  find("help-open").addEventListener("click", () => find("help").showModal());
}
