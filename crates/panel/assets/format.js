// Numbers and times as people read them.

/**
 * A number with so many significant digits; a dash for none.
 * @param {number | null | undefined} value
 * @param {number} [digits]
 * @returns {string}
 */
export function shown(value, digits = 3) {
  if (value == null || !Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-3 || size >= 1e6)) return value.toExponential(2).replaceAll("-", "−");
  const decimals = size === 0 ? digits - 1 : Math.max(0, digits - 1 - Math.floor(Math.log10(size)));
  return fixed(value, Math.min(decimals, 6));
}

/**
 * A number with so many digits behind the point: it does not jump when it changes. No minus before a zero.
 * @param {number | null | undefined} value
 * @param {number} decimals
 * @returns {string}
 */
export function fixed(value, decimals) {
  if (value == null || !Number.isFinite(value)) return "–";
  const text = value.toFixed(decimals);
  return Number(text) === 0 ? text.replace("-", "") : text.replace("-", "−");
}

/**
 * A time on the source's clock.
 * @param {number} t seconds
 * @returns {string}
 */
export function clock(t) {
  if (t < 60) return `${fixed(t, 2)} s`;
  const minutes = Math.floor(t / 60);
  const rest = (t - 60 * minutes).toFixed(1).padStart(4, "0");
  return `${minutes}:${rest}`;
}

/**
 * Turns per minute.
 * @param {number} rad_s
 * @returns {number}
 */
export function rpm(rad_s) {
  return (30 / Math.PI) * rad_s;
}

/**
 * Time of day, as 12:03:07.
 * @param {Date} when
 * @returns {string}
 */
export function timeOfDay(when) {
  return [when.getHours(), when.getMinutes(), when.getSeconds()].map((part) => String(part).padStart(2, "0")).join(":");
}

/**
 * Time of day, with the date unless it is today's.
 * @param {number} unix_s seconds since 1970
 * @param {Date} [today]
 * @returns {string}
 */
export function moment(unix_s, today = new Date()) {
  const when = new Date(1000 * unix_s);
  const date = [when.getFullYear(), when.getMonth() + 1, when.getDate()].map((part) => String(part).padStart(2, "0")).join("-");
  return when.toDateString() === today.toDateString() ? timeOfDay(when) : `${date} ${timeOfDay(when)}`;
}

/**
 * A probability, percent.
 * @param {number} value
 * @returns {string}
 */
export function percent(value) {
  return value >= 99.5 && value < 100 ? "> 99 %" : `${fixed(value, 0)} %`;
}

/**
 * `a`, `a or b`, `a, b or c`.
 * @param {string[]} words
 * @returns {string}
 */
export function either(words) {
  if (words.length < 2) return words.join("");
  return `${words.slice(0, -1).join(", ")} or ${words[words.length - 1]}`;
}
