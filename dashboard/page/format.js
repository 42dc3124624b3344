// Numbers and times as text. Unknown values become a dash.

export const DASH = "–";
const known = (value) => typeof value === "number" && Number.isFinite(value);

/** A number with `digits` significant digits, without an exponent between 1e-3 and 1e5. */
export function number(value, digits = 3) {
  if (!known(value)) return DASH;
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size < 1e-3 || size >= 1e5) return value.toExponential(digits - 1).replace("e+", "e");
  const places = Math.max(0, digits - 1 - Math.floor(Math.log10(size)));
  return value.toFixed(places);
}

/** "0.752 ± 0.012": the error has two significant digits. */
export function withError(value, sigma) {
  if (!known(value)) return DASH;
  if (!known(sigma) || sigma <= 0) return number(value, 4);
  const places = Math.min(8, Math.max(0, 1 - Math.floor(Math.log10(sigma))));
  return `${value.toFixed(places)} ± ${sigma.toFixed(places)}`;
}

export function seconds(value) {
  if (!known(value)) return DASH;
  const sign = value < 0 ? "−" : "";
  let left = Math.abs(value);
  if (left < 1) return `${sign}${Math.round(left * 1000)} ms`;
  if (left < 60) return `${sign}${left.toFixed(1)} s`;
  left = Math.round(left);
  const [hours, minutes, rest] = [Math.floor(left / 3600), Math.floor(left / 60) % 60, left % 60];
  const two = (n) => String(n).padStart(2, "0");
  return hours ? `${sign}${hours} h ${two(minutes)} min` : `${sign}${minutes} min ${two(rest)} s`;
}

/** "3:05" or "1:03:05". */
export function stopwatch(value) {
  if (!known(value)) return DASH;
  const left = Math.max(0, Math.floor(value));
  const two = (n) => String(n).padStart(2, "0");
  const hours = Math.floor(left / 3600);
  return `${hours ? `${hours}:${two(Math.floor(left / 60) % 60)}` : Math.floor(left / 60)}:${
      two(left % 60)}`;
}

export function timeOfDay(us) {
  return known(us) && us > 0 ? new Date(us / 1000).toLocaleTimeString([], {hour12: false}) : DASH;
}

/** A number in superscript digits. */
export const raised = (power) =>
    String(power).replace("-", "⁻").replace(/\d/g, (digit) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[digit]);

/** "cm^2/s" -> "cm²/s". */
export function unit(text) {
  if (!text || text === "1") return "";
  return text.replace(/\^(-?\d)/g, (_, power) => raised(power));
}

const UNITS = [
  ["_per_s", "1/s"], ["_cm_s", "cm/s"], ["_rad_s", "rad/s"], ["_deg_s", "deg/s"], ["_percent", "%"],
  ["_cm", "cm"], ["_mm", "mm"], ["_deg", "deg"], ["_ms", "ms"], ["_us", ""], ["_Hz", "Hz"],
  ["_MB", "MB"], ["_px", "px"], ["_V", "V"], ["_s", "s"]
];

/** A key of the JSON as a heading: "rate_Hz" -> "rate (Hz)". */
export function heading(key) {
  for (const [ending, name] of UNITS) {
    if (!key.endsWith(ending)) continue;
    const word = key.slice(0, -ending.length).replaceAll("_", " ");
    return name ? `${word} (${name})` : word;
  }
  return key.replaceAll("_", " ");
}

/** Any JSON value as text; its key gives the unit. */
export function plain(value, key = "") {
  if (value === null || value === undefined || value === "") return DASH;
  if (key.endsWith("_us")) return timeOfDay(value);
  if (typeof value === "boolean") return value ? "yes" : "no";
  if (typeof value === "number")
    return Number.isInteger(value) ? String(value) : String(Number(value.toPrecision(4)));
  if (Array.isArray(value)) return value.map((one) => plain(one)).join(" ");
  if (typeof value === "object") {
    return Object.entries(value)
        .map(([name, one]) => `${heading(name)} ${plain(one, name)}`)
        .join(", ");
  }
  return String(value);
}

/** "3, 7, 12 and 8 more". */
export function list(items, most = 12) {
  const shown = items.slice(0, most).join(", ");
  return items.length > most ? `${shown} and ${items.length - most} more` : shown;
}
