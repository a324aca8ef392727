// Colours: those of the style sheet, the scale of utilisation, and one for each chosen joint.

const CHOSEN = ["#1f77d0", "#d1495b", "#2a9d6f", "#9a4fb0", "#e08a1e", "#0e8c9b", "#8c6d31", "#6b7280"];

class Palette {
  constructor() {
    this.read();
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { this.read(); this.onChange(); });
    this.onChange = () => {};
  }

  read() {
    const style = getComputedStyle(document.documentElement);
    const colour = (name) => style.getPropertyValue(`--${name}`).trim();
    for (const name of ["paper", "ground", "ink", "soft", "line", "still", "piece", "loose", "edge", "accent",
      "N", "Q", "M", "contact", "reference", "bad", "used"]) this[name] = colour(name);
    this.stops = [[0, "calm"], [0.7, "busy"], [1, "full"]].map(([at, name]) => [at, channels(colour(name))]);
  }

  // Colour of a utilisation from 0 to 1.
  utilisation(share) {
    const [[x0, from], [x1, to]] = share < this.stops[1][0] ? this.stops : this.stops.slice(1);
    const t = Math.min(1, Math.max(0, (share - x0) / (x1 - x0)));
    return `rgb(${from.map((value, i) => Math.round(value + t * (to[i] - value))).join(" ")})`;
  }
}

function channels(hex) {
  return [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));
}
