// Chosen joints: their N, Q, M as numbers, as shares of their maxima, the plastic capacity used; curves over time.

const QUANTITIES = [["N", "N"], ["Q", "N"], ["M", "N m"]];

class JointCards {
  constructor(recording, palette, onSeek) {
    Object.assign(this, { recording, palette, onSeek });
    this.chosen = [];
    this.onChange = () => {};
    this.cards = document.getElementById("cards");
    this.plots = [];
    this.shortcuts = this.busiest(6).map((j) => {
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = recording.joints[j].label;
      button.addEventListener("click", () => this.toggle(j));
      document.getElementById("busiest").append(button);
      return [j, button];
    });
    document.getElementById("clear").addEventListener("click", () => this.choose([]));
  }

  // Joints that used most of their plastic capacity, or came nearest to it.
  busiest(count) {
    const last = this.recording.time.length - 1;
    const rank = this.recording.joints.map(({ peak, maxima }, j) => {
      const share = Math.max(0, ...peak.map((value, kind) => (maxima[kind] ? value / maxima[kind] : 0)));
      return [j, this.recording.used(j, last) * 10 + share];
    });
    return rank.sort((one, other) => other[1] - one[1]).slice(0, count).map(([j]) => j);
  }

  toggle(j) {
    this.choose(this.chosen.includes(j) ? this.chosen.filter((other) => other !== j) : [...this.chosen, j].slice(-CHOSEN.length));
  }

  choose(joints) {
    this.chosen = joints;
    document.getElementById("clear").hidden = joints.length === 0;
    for (const [j, button] of this.shortcuts) button.setAttribute("aria-pressed", String(joints.includes(j)));
    this.cards.replaceChildren(...joints.map((j, place) => this.card(j, place)));
    this.drawCurves();
    this.onChange();
  }

  card(j, place) {
    const card = document.createElement("article");
    card.className = "card";
    card.dataset.joint = j;
    const head = document.createElement("h3"), mark = document.createElement("span"), close = document.createElement("button");
    mark.className = "badge";
    mark.style.background = CHOSEN[place];
    mark.textContent = place + 1;
    close.type = "button";
    close.textContent = "×";
    close.setAttribute("aria-label", `Remove ${this.recording.joints[j].label}`);
    close.addEventListener("click", () => this.toggle(j));
    head.append(mark, this.recording.joints[j].label, close);
    const table = document.createElement("table");
    table.createTHead().innerHTML = "<tr><th></th><th>now</th><th>of max</th><th>max</th><th>peak</th></tr>";
    for (const name of [...FORCE_KINDS, "plastic used"]) {
      const row = table.insertRow();
      row.dataset.quantity = name;
      for (let i = 0; i < 5; i++) row.insertCell();
      row.cells[0].textContent = name;
    }
    // The last row says in its wide cells what needs no number.
    const { cells } = table.rows[4];
    cells[0].colSpan = 2;
    cells[3].colSpan = 2;
    cells[3].className = "broken";
    cells[4].remove();
    cells[1].remove();
    card.append(head, table);
    return card;
  }

  // Numbers at a sample.
  update(k) {
    const { recording } = this;
    this.chosen.forEach((j, place) => {
      const joint = recording.joints[j], rows = this.cards.children[place].querySelectorAll("tr[data-quantity]");
      QUANTITIES.forEach(([, unit], kind) => {
        const most = joint.maxima[kind];
        fill(rows[kind], withUnit(recording.force(j, kind, k), unit), most ? recording.share(j, kind, k) : null,
          withUnit(most, unit), withUnit(joint.peak[kind], unit));
      });
      const note = recording.broken(j, k) ? `broken at ${seconds(recording.time[joint.brokenFrom], 0.01)}` : "";
      showShare(rows[3].cells[1], recording.used(j, k));
      rows[3].cells[2].textContent = note;
    });
  }

  drawCurves() {
    const { recording, chosen, palette } = this, parent = document.getElementById("curves");
    if (chosen.length === 0) {
      parent.replaceChildren();
      this.plots = [];
      return;
    }
    if (this.plots.length === 0) this.plots = [92, 92, 92, 72].map((height) => new Plot(parent, palette, height, this.onSeek));
    const samples = recording.time.map((_, k) => k);
    const series = (value) => chosen.map((j, place) => ({ colour: CHOSEN[place], values: samples.map((k) => value(j, k)) }));
    QUANTITIES.forEach(([name, unit], kind) => {
      const limits = chosen.map((j) => recording.joints[j].maxima[kind]).filter(Boolean).flatMap((most) => [most, -most]);
      this.plots[kind].show(name, unit, recording.time, series((j, k) => recording.force(j, kind, k)), [...new Set(limits)]);
    });
    this.plots[3].show("plastic capacity used", "%", recording.time, series((j, k) => recording.used(j, k)));
  }

  drawCursors(time) {
    for (const plot of this.plots) plot.drawCursor(time);
  }
}

// A row of numbers: the value now, its share of what is possible, that maximum, the peak.
function fill(row, now, share, most, peak) {
  [now, "", most, peak].forEach((text, i) => { row.cells[i + 1].textContent = text; });
  if (share !== null) showShare(row.cells[2], share);
}

// A share in words and as a gauge.
function showShare(cell, share) {
  const gauge = document.createElement("div"), bar = document.createElement("i");
  gauge.className = "gauge";
  bar.style.width = `${100 * Math.min(1, share)}%`;
  gauge.append(bar);
  cell.replaceChildren(percent(share), gauge);
}
