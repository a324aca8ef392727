// Numbers with units, as an engineer writes them.

const PREFIXES = [[1e9, "G"], [1e6, "M"], [1e3, "k"], [1, ""], [1e-3, "m"], [1e-6, "µ"]];
const MINUS = "\u2212", THIN = "\u202f";

// The prefix that suits a value: [factor, letter].
function prefixOf(value) {
  const size = Math.abs(value);
  return PREFIXES.find(([factor]) => size >= 0.9995 * factor) || (size === 0 ? [1, ""] : PREFIXES.at(-1));
}

// Four significant digits with a prefix: 147700 N m is "147.7 kN m".
function withUnit(value, unit) {
  if (value === null) return "no limit";
  const [factor, letter] = prefixOf(value);
  return `${digits(value / factor, 4)}${THIN}${letter}${unit}`;
}

function digits(value, count) {
  if (value === 0) return "0";
  const whole = Math.max(1, Math.floor(Math.log10(Math.abs(value)) + 1e-9) + 1);
  return value.toFixed(Math.max(0, count - whole)).replace("-", MINUS);
}

function percent(share) {
  return `${(100 * share).toFixed(share < 0.0995 ? 2 : share < 0.9995 ? 1 : 0)}${THIN}%`;
}

function seconds(value, resolution) {
  const places = Math.min(6, Math.max(2, Math.ceil(-Math.log10(resolution) + 0.3)));
  return `${value.toFixed(places)}${THIN}s`;
}

// A round number with a prefix and no more digits than it needs: 500 mm.
function roundWithUnit(value, unit) {
  const [factor, letter] = prefixOf(value);
  return `${Number((value / factor).toPrecision(6))}${THIN}${letter}${unit}`;
}

// Round steps for an axis from low to high, about so many.
function ticks(low, high, count) {
  const rough = (high - low) / count || 1;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * ([1, 2, 5].find((m) => m * power >= rough) || 10);
  const marks = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) marks.push(k * step);
  return marks;
}

// The largest of 1, 2, 5 × 10ⁿ that is not above a value.
function roundBelow(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return power * [5, 2, 1].find((m) => m * power <= value * (1 + 1e-9));
}
