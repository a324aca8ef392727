// The page: the parts above, wired to each other, to the controls and to the keyboard.

const byId = (id) => document.getElementById(id);

async function start() {
  const recording = await Recording.read(byId("payload"));
  const palette = new Palette();
  const player = new Player(recording.time);
  const stage = new Stage(byId("stage"), recording, palette);
  const cards = new JointCards(recording, palette, (time) => player.seek(time));
  const ledger = new EnergyLedger(recording, palette, (time) => player.seek(time));
  const sampling = recording.duration / Math.max(1, recording.time.length - 1);
  let waiting = false;

  byId("facts").textContent = facts(recording, sampling);
  showControls(recording, player, stage);

  function redraw() {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => {
      waiting = false;
      const moment = recording.momentAt(player.time);
      stage.draw(moment, cards.chosen);
      cards.update(moment.k);
      cards.drawCursors(player.time);
      ledger.update(moment.k, player.time);
      showTime(recording, player, sampling);
      showLegend(stage);
    });
  }

  function redrawAll() {
    stage.resize();
    drawMarks(recording, palette);
    cards.drawCurves();
    ledger.draw();
    redraw();
  }

  player.onChange = redraw;
  cards.onChange = redraw;
  palette.onChange = redrawAll;
  stage.camera.onChange = redraw;
  const jointAt = (point, reach) => stage.jointAt(point, recording.momentAt(player.time), reach);
  stage.camera.onTap = (point, reach) => { const j = jointAt(point, reach); if (j !== null) cards.toggle(j); };
  stage.camera.onHover = (point) => {
    const j = jointAt(point, 12);
    byId("stage").classList.toggle("over-joint", j !== null);
    byId("stage").title = j === null ? "" : recording.joints[j].label;
  };
  new ResizeObserver(() => { stage.resize(); drawMarks(recording, palette); redraw(); }).observe(byId("view"));
  connect(recording, player, stage, cards, redraw);
  redrawAll();

  // For whoever opens the console, and for tests.
  window.replay = {
    recording, player, stage, cards,
    onScreen: (j) => stage.camera.toScreen(recording.place(j, recording.momentAt(player.time)).a),
  };
}

const count = (number, one, many) => `${number} ${number === 1 ? one : many}`;

function facts(recording, sampling) {
  const dynamic = recording.bodies.filter((body) => body.kind === "dynamic").length;
  const { step, gravity, iterations } = recording.settings;
  const rate = (period) => (period > 0 ? `1/${Number((1 / period).toPrecision(4))}${THIN}s` : "none");
  return [
    count(dynamic, "body", "bodies"), count(recording.joints.length, "joint", "joints"), `step ${rate(step)}`,
    count(iterations, "iteration", "iterations"),
    `gravity ${digits(-gravity, 3)}${THIN}m/s²`, `sampled every ${rate(sampling)}`,
  ].join(" · ");
}

function showControls(recording, player, stage) {
  byId("scrub").max = recording.duration || 1;
  byId("joint-section").hidden = recording.joints.length === 0;
  byId("speed").append(...SPEEDS.map((speed) => new Option(`${speed} ×`, speed)));
  for (const box of document.querySelectorAll("[data-force]")) box.checked = stage.forces.shown[box.dataset.force];
  if (recording.reference) {
    byId("reference-label").hidden = false;
    byId("reference-label").querySelector("span").textContent = recording.reference.label;
  }
}

function showTime(recording, player, sampling) {
  byId("play").classList.toggle("playing", player.playing);
  byId("play").setAttribute("aria-label", player.playing ? "Pause" : "Play");
  byId("scrub").value = player.time;
  byId("scrub").setAttribute("aria-valuetext", seconds(player.time, sampling));
  byId("clock").textContent = `${seconds(player.time, sampling)} of ${seconds(recording.duration, sampling)}`;
  byId("speed").value = player.speed;
}

let lastLegend = "";

function showLegend(stage) {
  const bars = stage.forces.bars(stage.camera);
  const rows = bars.map(({ name, pixels, text }) =>
    `<div class="bar"><i class="swatch ${name}" style="width:${pixels.toFixed(0)}px"></i>${name} ${text}</div>`);
  const metres = roundBelow(90 / stage.camera.scale);
  const html = `<div class="ramp"></div><div class="ramp-ends"><span>0</span><span>utilisation</span><span>1</span></div>
    <div class="bar"><i class="swatch" style="width:${(metres * stage.camera.scale).toFixed(0)}px;background:var(--soft)"></i>${roundWithUnit(metres, "m")}</div>
    ${rows.join("")}`;
  // The document is only touched when something changed.
  if (html !== lastLegend) byId("legend").innerHTML = lastLegend = html;
}

// Along the track: when joints broke.
function drawMarks(recording, palette) {
  const canvas = byId("marks"), ratio = window.devicePixelRatio || 1, pen = canvas.getContext("2d");
  canvas.width = canvas.clientWidth * ratio;
  canvas.height = canvas.clientHeight * ratio;
  pen.scale(ratio, ratio);
  pen.fillStyle = palette.bad;
  for (const { brokenFrom } of recording.joints) {
    if (brokenFrom !== null) pen.fillRect(8 + (canvas.clientWidth - 16) * recording.time[brokenFrom] / recording.duration - 1, 1, 2, 6);
  }
}

function connect(recording, player, stage, cards, redraw) {
  byId("play").addEventListener("click", () => player.toggle());
  byId("scrub").addEventListener("input", (event) => player.seek(Number(event.target.value)));
  byId("speed").addEventListener("change", (event) => { player.speed = Number(event.target.value); redraw(); });
  byId("zoom-in").addEventListener("click", () => stage.camera.zoom(1.4));
  byId("zoom-out").addEventListener("click", () => stage.camera.zoom(1 / 1.4));
  byId("fit").addEventListener("click", () => stage.fit());
  byId("fit-all").addEventListener("click", () => stage.fitAll());
  byId("reference").addEventListener("change", (event) => { stage.showReference = event.target.checked; redraw(); });
  byId("force-scale").addEventListener("input", (event) => {
    stage.forces.scale = 10 ** Number(event.target.value);
    byId("force-scale-value").textContent = `${digits(stage.forces.scale, 2)} ×`;
    redraw();
  });
  byId("force-scale-value").textContent = "1.0 ×";
  const boxes = [...document.querySelectorAll("[data-force]")];
  for (const box of boxes) {
    box.addEventListener("change", () => { stage.forces.shown[box.dataset.force] = box.checked; redraw(); });
  }
  const flip = (name) => boxes.find((box) => box.dataset.force === name).click();
  const nextJoint = (count) => {
    const n = recording.joints.length, from = cards.chosen.at(-1) ?? (count > 0 ? -1 : 0);
    if (n > 0) cards.choose([(from + count + n) % n]);
  };
  const keys = {
    " ": () => player.toggle(),
    ArrowLeft: (event) => player.step(event.shiftKey ? -10 : -1),
    ArrowRight: (event) => player.step(event.shiftKey ? 10 : 1),
    Home: () => player.seek(0),
    End: () => player.seek(recording.duration),
    "[": () => player.faster(-1),
    "]": () => player.faster(1),
    "+": () => stage.camera.zoom(1.4),
    "=": () => stage.camera.zoom(1.4),
    "-": () => stage.camera.zoom(1 / 1.4),
    f: () => stage.fit(),
    a: () => stage.fitAll(),
    n: () => flip("N"), q: () => flip("Q"), m: () => flip("M"), c: () => flip("contact"),
    ",": () => nextJoint(-1),
    ".": () => nextJoint(1),
    Escape: () => cards.choose([]),
  };
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    // Controls keep the keys that are theirs: a button its space bar, a slider its arrows.
    const control = event.target.closest("button, select, input, summary");
    if (control && (event.key === " " || (control.id !== "scrub" && /^(Arrow|Home|End)/.test(event.key)))) return;
    const act = keys[event.key] || keys[event.key.toLowerCase()];
    if (!act) return;
    event.preventDefault();
    act(event);
  });
}

start().catch((error) => {
  byId("message").textContent = error.message;
  byId("message").classList.add("fault");
});
