// The controls of the 3D view: which tets are shown, in which colours. K3D, which draws them, stands in the page as text.
"use strict";

// Corners of the facet opposite each vertex, counter-clockwise from outside.
const FACETS = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];
const GREY = 0xb4bac2, GLASS = 0x7d8896;
const SKIN = 1, LINES = 2, GHOST = 3;
const view = document.getElementById("view");
const control = name => view.querySelector(`[name="${name}"]`);

const bytes = id => Uint8Array.from(atob(document.getElementById(id).textContent), one => one.charCodeAt(0));
const unpacked = id =>
  new Response(new Blob([bytes(id)]).stream().pipeThrough(new DecompressionStream("deflate"))).arrayBuffer();

async function library() {
  let made;
  window.define = (name, needs, make) => { made = make(); };
  const code = URL.createObjectURL(new Blob([await unpacked("view-library")], { type: "text/javascript" }));
  await new Promise((done, failed) => {
    const script = document.createElement("script");
    Object.assign(script, { src: code, onload: done, onerror: failed });
    document.head.append(script);
  });
  URL.revokeObjectURL(code);
  return made;
}

// Each facet 4 t + k, opposite vertex k of tet t, and the one on its other side, -1 where there is none.
function twins(tets, points) {
  const head = new Int32Array(points).fill(-1), next = new Int32Array(tets.length);
  const middle = new Uint32Array(tets.length), top = new Uint32Array(tets.length);
  const twin = new Int32Array(tets.length).fill(-1);
  for (let f = 0; f < tets.length; f++) {
    const [a, b, c] = FACETS[f & 3].map(k => tets[(f & ~3) + k]).sort((x, y) => x - y);
    let g = head[a];
    while (g >= 0 && (middle[g] !== b || top[g] !== c)) g = next[g];
    if (g >= 0) { twin[f] = g; twin[g] = f; continue; }
    middle[f] = b; top[f] = c; next[f] = head[a]; head[a] = f;
  }
  return twin;
}

// One mesh: its arrays as they lie behind one another in what Python packed.
async function mesh(about, k) {
  const data = await unpacked(`view-mesh-${k}`), found = { about };
  let at = 0;
  for (const [name, type, count] of about.arrays) {
    const Kind = { f4: Float32Array, u4: Uint32Array, u2: Uint16Array, u1: Uint8Array }[type];
    found[name] = new Kind(data, at, count);
    at += count * Kind.BYTES_PER_ELEMENT;
  }
  found.twin = twins(found.tets, found.points.length / 3);
  found.middle = Float32Array.from({ length: 3 * found.flags.length }, (_, i) => {
    const t = 4 * Math.floor(i / 3);
    return [0, 1, 2, 3].reduce((sum, j) => sum + found.points[3 * found.tets[t + j] + i % 3], 0) / 4;
  });
  return found;
}

const value = (scale, packed) => scale.low + packed / 65534 * (scale.high - scale.low);
const mixed = (one, other, share) => [16, 8, 0].reduce(
  (sum, bits) => sum | Math.round((one >> bits & 255) * (1 - share) + (other >> bits & 255) * share) << bits, 0);

function colour(scale, at) {
  const stops = scale.stops;
  let k = 1;
  while (k < stops.length - 1 && at > stops[k][0]) k++;
  const [low, first] = stops[k - 1], [high, last] = stops[k];
  return mixed(first, last, Math.min(Math.max((at - low) / (high - low || 1), 0), 1));
}

// The colour of a tet's facet; skin: whether it lies on the boundary.
function colouring(one, settings) {
  const name = control("colour").value;
  if (name === "region") return t => settings.palette[one.region[t] % settings.palette.length];
  const scale = settings.scales[name];
  const table = Uint32Array.from({ length: 1024 }, (_, k) => colour(scale, value(scale, k * 64)));
  const packed = one[name];
  if (name === "deviation") return (t, skin) => skin && packed[t] < 65535 ? table[packed[t] >> 6] : GREY;
  // Above all bins below zero, none of them mixed with one that is not.
  if (name === "height") {
    return t => [, settings.obtuse][one.flags[t] & 3] ?? colour(scale, value(scale, packed[t]));
  }
  return t => colour(scale, value(scale, packed[t]));
}

// Which tets are shown: those on the kept side of the plane, and of these the ones that are asked for.
function chosen(one, settings) {
  const cut = control("clip").value, kept = new Uint8Array(one.flags.length), shown = new Uint8Array(one.flags.length);
  const place = clipAt(settings);
  const side = (control("flip").checked ? -1 : 1) * Math.sign(settings.eye.axes[2][cut] || 1);  // the cut is seen first
  const [name, order] = control("threshold").value.split(" ");
  const limit = limitAt(settings), scale = settings.scales[name], alone = control("alone").checked;
  for (let t = 0; t < kept.length; t++) {
    kept[t] = cut === "" || side * (one.middle[3 * t + Number(cut)] - place) <= 0;
    const enough = !scale || (order === "most") === (value(scale, one[name][t]) <= limit);
    shown[t] = kept[t] && enough && (!alone || (one.flags[t] & 3) > 0);
  }
  return [kept, shown];
}

const clipAt = settings => {
  const axis = Number(control("clip").value);
  return settings.low[axis] + control("place").value / 1000 * (settings.high[axis] - settings.low[axis]);
};
const limitAt = settings => {
  const scale = settings.scales[control("threshold").value.split(" ")[0]];
  return scale && scale.low + control("limit").value / 1000 * (scale.high - scale.low);
};

// Where the camera is, what it looks at and which way is up, so that all of the box is in the picture.
function camera({ axes, middle, reach, degrees, up }, place) {
  const aspect = place.clientWidth / place.clientHeight;
  const away = reach[2] + 1.06 * Math.max(reach[1], reach[0] / aspect) / Math.tan(degrees / 360 * Math.PI);
  return [...middle.map((at, k) => at + away * axes[2][k]), ...middle, ...[..."xyz"].map(axis => Number(axis === up))];
}

// A mesh of K3D from facets, each with corners of its own, so that each has its own colour.
function facets(one, found, id, more, paint) {
  const vertices = new Float32Array(9 * found.length), colours = new Uint32Array(3 * found.length);
  found.forEach((f, i) => {
    const t = f >> 2;
    FACETS[f & 3].forEach((k, j) => {
      const p = 3 * one.tets[4 * t + k];
      vertices.set(one.points.subarray(p, p + 3), 9 * i + 3 * j);
    });
    if (paint) colours.fill(paint(t, one.flags[t] >> (2 + (f & 3)) & 1), 3 * i, 3 * i + 3);
  });
  return {
    id, type: "Mesh", visible: true, flat_shading: true, side: "front", color_range: [], roughness: 0.9,
    model_matrix: { data: new Float32Array([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]) },
    vertices: { data: vertices }, indices: { data: Uint32Array.from({ length: 3 * found.length }, (_, k) => k) },
    ...(paint ? { colors: { data: colours } } : {}), ...more,
  };
}

function draw(stage, settings) {
  const { plot, one } = stage, [kept, shown] = chosen(one, settings), bare = [], glass = [];
  let count = 0, all = true;
  for (let t = 0; t < shown.length; t++) { count += shown[t]; all = all && shown[t] === kept[t]; }
  for (let f = 0; f < one.tets.length; f++) {
    const t = f >> 2, other = one.twin[f];
    if (shown[t] && !(other >= 0 && shown[other >> 2])) bare.push(f);
    if (!all && kept[t] && one.flags[t] >> (2 + (f & 3)) & 1) glass.push(f);
  }
  const objects = new Map([[SKIN, bare.length && facets(one, bare, SKIN, {}, colouring(one, settings))]]);
  objects.set(LINES, control("edges").checked && bare.length
    && facets(one, bare, LINES, { wireframe: true, color: 0x333c48, opacity: 0.35 }));
  objects.set(GHOST, glass.length && facets(one, glass, GHOST, { color: GLASS, opacity: 0.14, side: "double" }));
  for (const [id, object] of objects) {
    if (object) plot.load({ objects: [object] });
    else if (plot.getWorld().ObjectsListJson[id]) plot.removeObject(id);
  }
  stage.said.textContent = `${count} of ${one.about.tets} tets shown`;
}

function legend(settings) {
  const name = control("colour").value, scale = settings.scales[name], place = view.querySelector(".legend");
  place.replaceChildren();
  const add = (kind, style, text = "") =>
    place.append(Object.assign(document.createElement("span"), { className: kind, style, textContent: text }));
  const hex = number => "#" + number.toString(16).padStart(6, "0");
  if (!scale) {
    settings.regions.forEach((tag, k) => {
      add("key", `background:${hex(settings.palette[k % settings.palette.length])}`);
      add("", "", tag);
    });
    return;
  }
  const share = at => `${100 * (at - scale.low) / (scale.high - scale.low)}%`;
  add("", "", scale.say[0]);
  add("bar", `background:linear-gradient(to right,${scale.stops.map(([at, one]) => `${hex(one)} ${share(at)}`)})`);
  add("", "", scale.say[1]);
  add("wide muted", "", scale.words);
}

async function start() {
  const settings = JSON.parse(document.getElementById("view-settings").textContent);
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const lib = await library(), stages = [];
  for (const [k, place] of [...view.querySelectorAll(".stage")].entries()) {
    const plot = new lib.K3D(lib.ThreeJsProvider, place, {
      menuVisibility: false, gridVisible: false, cameraAutoFit: false, cameraMode: "orbit", cameraUpAxis: settings.eye.up,
      cameraFov: settings.eye.degrees, axesHelper: 1, lighting: 1.6, cameraDampingFactor: 0,
    });
    stages.push({ plot, place, one: await mesh(settings.meshes[k], k), said: place.parentElement.querySelector("output") });
  }
  const ground = () => stages.forEach(({ plot }) => {
    plot.setClearColor(dark.matches ? 0x1b222b : 0xf5f7f9);
    plot.setLabelColor(dark.matches ? 0xe4eaf1 : 0x1c2430);
  });
  const home = () => {
    const at = camera(settings.eye, stages[0].place);
    stages.forEach(({ plot }) => plot.setCamera(at));
  };
  let linked = false;
  stages.forEach(({ plot }) => plot.on(plot.events.CAMERA_CHANGE, camera => {
    if (linked) return;
    linked = true;
    stages.forEach(other => other.plot !== plot && other.plot.setCamera(camera));
    linked = false;
  }));
  const show = () => {
    control("place").disabled = control("flip").disabled = control("clip").value === "";
    control("limit").disabled = control("threshold").value === "";
    const axis = Number(control("clip").value), limit = limitAt(settings);
    view.querySelector("[for=place]").textContent = control("clip").value === "" ? "the whole"
      : `${"xyz"[axis]} = ${(settings.center[axis] + clipAt(settings) * settings.size).toPrecision(4)}`;
    view.querySelector("[for=limit]").textContent = limit === undefined ? "no limit" : limit.toPrecision(3);
    legend(settings);
    stages.forEach(stage => draw(stage, settings));
  };
  view.querySelector(".controls").addEventListener("input", show);
  control("home").addEventListener("click", home);
  dark.addEventListener("change", ground);
  view.classList.add("on");
  ground();
  show();
  home();
}

const context = document.createElement("canvas").getContext("webgl2");
if (context && window.DecompressionStream) {
  context.getExtension("WEBGL_lose_context")?.loseContext();
  start().then(() => view.dataset.state = "drawn", fault => {
    view.classList.remove("on");
    view.dataset.state = "failed";
    console.error(fault);
  });
} else view.dataset.state = "stills";
