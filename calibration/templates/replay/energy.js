// The energy ledger: each account over time, and as numbers.

const ACCOUNT_COLOURS = {
  external: "#6b7280", kinetic: "#1f77d0", elastic: "#2a9d6f", plastic: "#d1495b", contact: "#e08a1e", viscous: "#9a4fb0",
  numerical: "#0e8c9b", stock: "#8c6d46",
};

class EnergyLedger {
  constructor(recording, palette, onSeek) {
    Object.assign(this, { recording });
    if (recording.energy.length === 0) return;
    document.getElementById("energy-section").hidden = false;
    const parent = document.getElementById("energy");
    this.plot = new Plot(parent, palette, 150, onSeek);
    const table = document.createElement("table");
    table.className = "ledger";
    this.values = recording.energy.map((name) => {
      const row = table.insertRow(), key = document.createElement("i"), value = row.insertCell();
      key.style.background = ACCOUNT_COLOURS[name];
      value.before(row.insertCell());
      row.cells[0].append(key, name);
      return row.cells[1];
    });
    parent.append(table);
    this.draw();
  }

  draw() {
    const { recording } = this, samples = recording.time.map((_, k) => k);
    const series = recording.energy.map((name, i) => ({
      colour: ACCOUNT_COLOURS[name], values: samples.map((k) => recording.energies.at(i, k)),
    }));
    this.plot?.show("energy", "J", recording.time, series);
  }

  update(k, time) {
    this.values?.forEach((cell, i) => { cell.textContent = withUnit(this.recording.energies.at(i, k), "J"); });
    this.plot?.drawCursor(time);
  }
}
