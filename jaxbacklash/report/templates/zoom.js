// A time series to look into: measured against model above, the residual over the noise below.
addEventListener("beforeprint", () => document.querySelectorAll("details").forEach((fold) => { fold.open = true; }));

const root = document.getElementById("look-closer");
if (!root) return;
const data = JSON.parse(document.getElementById("series").textContent);
const canvas = root.querySelector("canvas");
const pen = canvas.getContext("2d");
const readout = root.querySelector(".readout");
const t = data.t, last = t.length - 1;
if (last < 1) {
  root.hidden = true;
  return;
}
const whole = [t[0], t[last]];
const shortest = 6 * (whole[1] - whole[0]) / Math.max(6, data.samples - 1);
let view = whole.slice(), pointed = null, waiting = false;
if (data.samples > t.length) {
  root.querySelector(".thinned").textContent =
    `${t.length} of ${data.samples} samples are kept here, all peaks among them.`;
}

// The model starts anew at each window, so its line must not join them.
const fresh = new Uint8Array(t.length);
for (const start of data.windows) {
  const at = indexAt(t, start - 1e-9 * Math.abs(start));
  if (at < t.length) fresh[at] = 1;
}

function look(from, to) {
  const width = Math.min(Math.max(to - from, shortest), whole[1] - whole[0]);
  const start = Math.min(Math.max((from + to - width) / 2, whole[0]), whole[1] - width);
  view = [start, start + width];
  redraw();
}
function zoom(factor, about = (view[0] + view[1]) / 2) {
  look(about + (view[0] - about) * factor, about + (view[1] - about) * factor);
}
function move(share) {
  const step = share * (view[1] - view[0]);
  const kept = Math.min(Math.max(step, whole[0] - view[0]), whole[1] - view[1]);
  look(view[0] + kept, view[1] + kept);
}
function worst() {
  let at = 0;
  data.residual.forEach((value, i) => {
    if (value !== null && Math.abs(value) > Math.abs(data.residual[at] || 0)) at = i;
  });
  const half = data.windows.length > 1 ? 2.5 * (data.windows[1] - data.windows[0]) : (whole[1] - whole[0]) / 40;
  look(t[at] - half, t[at] + half);
}
const actions = {
  in: () => zoom(0.5), out: () => zoom(2), left: () => move(-0.4), right: () => move(0.4), worst,
  whole: () => look(...whole),
};

function redraw() {
  if (waiting) return;
  waiting = true;
  requestAnimationFrame(() => { waiting = false; draw(); });
}

function draw() {
  const width = canvas.clientWidth, height = canvas.clientHeight;
  if (!width || !height) return;
  const density = window.devicePixelRatio || 1;
  canvas.width = Math.round(width * density);
  canvas.height = Math.round(height * density);
  pen.setTransform(density, 0, 0, density, 0, 0);
  pen.clearRect(0, 0, width, height);
  const css = getComputedStyle(root), colour = (name) => css.getPropertyValue(name).trim();
  const ink = colour("--text"), faint = colour("--line"), quiet = colour("--quiet");
  const left = 72, right = width - 12, split = Math.round(0.63 * height);
  const across = (time) => left + (time - view[0]) / (view[1] - view[0]) * (right - left);
  const first = Math.max(0, indexAt(t, view[0]) - 1), end = Math.min(t.length, indexAt(t, view[1]) + 2);
  const sparse = end - first < (right - left) / 1.5;
  pen.font = `12px ${css.fontFamily}`;

  const unit = data.unit ? ` [${data.unit}]` : "";
  panel(26, split - 20, limits([data.measured, data.model], first, end, 0), data.label + unit, (up) => {
    stroke(data.measured, up, colour("--measured"), sparse ? 1 : 1.6, null, sparse);
    stroke(data.model, up, colour("--model"), 1.3, fresh, false);
  });
  panel(split + 22, height - 40, limits([data.residual], first, end, 3), "residual / noise", (up) => {
    pen.globalAlpha = 0.2;
    pen.fillStyle = colour("--gap");
    pen.fillRect(left, up(2), right - left, up(-2) - up(2));
    pen.globalAlpha = 1;
    stroke(data.residual, up, colour("--measured"), 1, fresh, sparse);
  });
  pen.fillStyle = ink;
  pen.textAlign = "center";
  pen.textBaseline = "bottom";
  for (const [value, text] of steps(view[0], view[1], Math.max(3, width / 110))) {
    pen.fillText(text, across(value), height - 22);
  }
  pen.fillText("time [s]", (left + right) / 2, height - 4);
  legend();
  if (pointed !== null) {
    pen.fillStyle = quiet;
    pen.fillRect(across(t[pointed]), 26, 1, height - 66);
  }
  root.dataset.view = view.map((time) => time.toPrecision(6)).join(" ");
  root.dataset.drawn = String(end - first);

  function panel(top, bottom, [low, high], name, inside) {
    const up = (value) => bottom - (value - low) / (high - low) * (bottom - top);
    pen.fillStyle = ink;
    pen.globalAlpha = 0.05;
    const shown = data.windows.filter((start) => start < view[1]).length;
    const each = data.windows.length > 1 ? across(data.windows[1]) - across(data.windows[0]) : 0;
    for (let k = 0; each > 20 && k < shown; k += 2) {  // narrower stripes would only be a haze
      const next = data.windows[k + 1] ?? whole[1];
      if (next < view[0]) continue;
      const from = Math.max(left, across(data.windows[k]));
      pen.fillRect(from, top, Math.min(right, across(next)) - from, bottom - top);
    }
    pen.globalAlpha = 1;
    pen.textAlign = "right";
    pen.textBaseline = "middle";
    for (const [value, text] of steps(low, high, Math.max(2, (bottom - top) / 34))) {
      pen.fillStyle = faint;
      pen.fillRect(left, Math.round(up(value)), right - left, 1);
      pen.fillStyle = ink;
      pen.fillText(text, left - 6, up(value));
    }
    pen.textAlign = "left";
    pen.textBaseline = "bottom";
    pen.fillText(name, 8, top - 6);
    pen.save();
    pen.beginPath();
    pen.rect(left, top, right - left, bottom - top);
    pen.clip();
    inside(up);
    pen.restore();
  }

  function stroke(values, up, paint, thickness, breaks, dotted) {
    pen.strokeStyle = pen.fillStyle = paint;
    pen.lineWidth = thickness;
    pen.beginPath();
    let joined = false;
    for (let i = first; i < end; i++) {
      const value = values[i];
      if (value === null) { joined = false; continue; }
      if (dotted) {
        pen.rect(across(t[i]) - 1.5, up(value) - 1.5, 3, 3);
        continue;
      }
      if (joined && !(breaks && breaks[i])) pen.lineTo(across(t[i]), up(value));
      else pen.moveTo(across(t[i]), up(value));
      joined = true;
    }
    if (dotted) pen.fill(); else pen.stroke();
  }

  function legend() {
    pen.textAlign = "right";
    pen.textBaseline = "bottom";
    let at = right;
    for (const [text, dot] of [["model", false], ["measured", true]]) {
      pen.fillStyle = ink;
      pen.fillText(text, at, 20);
      at -= pen.measureText(text).width + 8;
      pen.fillStyle = colour(`--${text}`);
      if (dot) pen.fillRect(at - 6, 9, 6, 6); else pen.fillRect(at - 18, 11, 18, 2);
      at -= 34;
    }
  }
}

function timeAt(x) {
  const box = canvas.getBoundingClientRect();
  return view[0] + (x - box.left - 72) / (box.width - 84) * (view[1] - view[0]);
}
function tell(x) {
  const time = timeAt(x), after = Math.min(indexAt(t, time), last), before = Math.max(0, after - 1);
  pointed = time - t[before] < t[after] - time ? before : after;
  readout.textContent = `t ${plain(t[pointed], 7)} s: measured ${plain(data.measured[pointed], 6)} ${data.unit}, ` +
    `model ${plain(data.model[pointed], 6)} ${data.unit}, residual ${plain(data.residual[pointed], 3)} times the noise`;
  redraw();
}

root.querySelectorAll("button").forEach((button) => button.addEventListener("click", actions[button.dataset.do]));
canvas.addEventListener("keydown", (event) => {
  const keys = { ArrowLeft: "left", ArrowRight: "right", "+": "in", "=": "in", "-": "out", 0: "whole", Home: "whole" };
  if (event.ctrlKey || event.metaKey || event.altKey || !(event.key in keys)) return;
  event.preventDefault();
  actions[keys[event.key]]();
});
canvas.addEventListener("wheel", (event) => {
  // Zooming out of the whole record scrolls the page on, so that nobody is caught here.
  if (event.deltaY > 0 && view[1] - view[0] >= whole[1] - whole[0]) return;
  event.preventDefault();
  zoom(Math.exp(Math.max(-1, Math.min(1, event.deltaY / 300))), timeAt(event.clientX));
}, { passive: false });
canvas.addEventListener("dblclick", actions.whole);

const fingers = new Map();
canvas.addEventListener("pointerdown", (event) => {
  fingers.set(event.pointerId, event.clientX);
  canvas.setPointerCapture(event.pointerId);
});
canvas.addEventListener("pointermove", (event) => {
  const before = [...fingers.values()];
  if (fingers.has(event.pointerId)) {
    fingers.set(event.pointerId, event.clientX);
    const now = [...fingers.values()];
    if (now.length === 1) {
      move((before[0] - now[0]) / (canvas.clientWidth - 84));
    } else if (now.length === 2) {
      const spread = Math.max(20, Math.abs(now[0] - now[1])), earlier = Math.max(20, Math.abs(before[0] - before[1]));
      zoom(earlier / spread, timeAt((now[0] + now[1]) / 2));
    }
  }
  tell(event.clientX);
});
for (const name of ["pointerup", "pointercancel"]) {
  canvas.addEventListener(name, (event) => fingers.delete(event.pointerId));
}
canvas.addEventListener("pointerleave", () => {
  pointed = null;
  readout.textContent = "\u00a0";
  redraw();
});

new ResizeObserver(redraw).observe(canvas);
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
draw();
