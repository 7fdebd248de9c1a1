// The local page: state comes from the server, the view (step, recording, window) from the address.

import { Plots, unpacked } from "./plots.js";
import { Faults } from "./faults.js";
import { Diagnosis } from "./diagnosis.js";

const $ = (id) => document.getElementById(id);
const base = location.pathname;
const mostBytes = Number(document.body.dataset.mostBytes);

const views = ["loop", "diagnose", "faults"];

// What is looked at, as the address holds it.
const view = { step: 0, ghost: null, recording: 0, window: null, view: "loop" };
// What the server said last, and what is shown of it.
const shown = { version: 0, beginning: 0, steps: 0, html: new Map(), signals: "", within: "", asked: "" };
// Set while a step that this tab asked for is being made: it is gone to when it is there.
let follow = null;

/* The address */

function readAddress() {
  const said = new URLSearchParams(location.hash.slice(1));
  const number = (key) => said.has(key) && Number.isFinite(Number(said.get(key))) ? Number(said.get(key)) : null;
  view.step = number("step") ?? 0;
  view.ghost = number("beside");
  view.recording = number("recording") ?? 0;
  const from = number("from"), to = number("to");
  view.window = from !== null && to !== null && from < to ? [from, to] : null;
  view.view = views.includes(said.get("view")) ? said.get("view") : "loop";
}

function writeAddress() {
  const say = new URLSearchParams();
  if (view.view !== "loop") say.set("view", view.view);
  if (view.step) say.set("step", view.step);
  if (view.ghost !== null) say.set("beside", view.ghost);
  if (view.recording) say.set("recording", view.recording);
  if (view.window) { say.set("from", Number(view.window[0].toPrecision(8))); say.set("to", Number(view.window[1].toPrecision(8))); }
  const hash = say.toString();
  history.replaceState(null, "", hash ? `#${hash}` : location.pathname);
}

function look(change) {
  Object.assign(view, change);
  writeAddress();
  return refresh();
}

/* The server */

function tell(words) {
  const place = $("problem");
  place.textContent = words ?? "";
  place.hidden = !words;
}

async function post(path, body) {
  tell();
  try {
    const answer = await fetch(base + path, { method: "POST", body: JSON.stringify(body), headers: { "content-type": "application/json" } });
    if (answer.ok) return answer.status === 204 ? {} : await answer.json();
    tell((await answer.json().catch(() => ({}))).problem ?? `The server answered ${answer.status}.`);
  } catch { tell("The server does not answer: has it been ended?"); }
  return null;
}

async function act(body) {
  if (["add", "law", "set", "fit"].includes(body.do)) follow = { from: view.step, steps: shown.steps };
  if (!await post("do", body)) follow = null;
}

async function upload(files) {
  tell();
  const study = [...files].find((it) => it.name.toLowerCase().endsWith(".json"));
  if (study) { goTo("faults"); await faults.file(study); return; }
  // The model first: recordings are compared with it.
  const all = [...files].sort((a, b) => b.name.toLowerCase().endsWith(".toml") - a.name.toLowerCase().endsWith(".toml"));
  for (const [place, file] of all.entries()) {
    if (file.size > mostBytes) {
      tell(`${file.name} has ${Math.ceil(file.size / 1e6)} MB, and ${mostBytes / 1e6} MB are taken: keep fewer rows or columns.`);
      return;
    }
    const more = place < all.length - 1;
    status({ title: "Reading", doing: file.name, errors: [] });
    try {
      const answer = await fetch(`${base}file?name=${encodeURIComponent(file.name)}&more=${more}`, { method: "POST", body: file });
      if (!answer.ok) {
        tell((await answer.json().catch(() => ({}))).problem ?? `${file.name} was refused.`);
        status(null);
        return;
      }
    } catch { tell(`${file.name} did not arrive.`); status(null); return; }
  }
}

/* What is being done */

function status(job) {
  const place = $("status");
  place.hidden = !job;
  document.body.classList.toggle("busy", !!job);
  if (!job) { place.replaceChildren(); return; }
  if (!place.firstChild) {
    place.innerHTML = '<strong></strong> <span></span> <svg viewBox="0 0 240 44" role="img"><path></path></svg> <output></output> <button type="button" data-do="cancel">Cancel</button>';
  }
  const [title, doing, chart, error] = place.children;
  title.textContent = job.title;
  doing.textContent = job.doing;
  const errors = job.errors.map((it) => Math.log10(Math.max(it, 1e-6)));
  chart.hidden = errors.length < 2;
  error.textContent = errors.length ? `error ${job.errors.at(-1).toPrecision(4)} (${errors.length} steps of the fit)` : "";
  if (errors.length > 1) {
    const most = Math.max(...errors), least = Math.min(...errors, 0), span = most - least || 1;
    const at = (value, k) => `${(4 + 232 * k / (errors.length - 1)).toFixed(1)} ${(40 - 36 * (value - least) / span).toFixed(1)}`;
    chart.firstChild.setAttribute("d", `M${errors.map(at).join("L")}`);
    chart.setAttribute("aria-label", `The error fell from ${job.errors[0].toPrecision(3)} to ${job.errors.at(-1).toPrecision(3)}`);
  }
}

let events = null;
function listen() {
  events = new EventSource(`${base}events`);
  events.onmessage = async (event) => {
    const news = JSON.parse(event.data);
    status(news.job);
    shown.there = news.steps > 0;
    if (news.problem) tell(news.problem);
    if (follow && news.steps > follow.steps) {
      const next = { step: news.steps - 1, ghost: follow.from };
      follow = null;
      await look(next);
    }
    if (!news.job) follow = null;
    const asked = `${news.recordings} ${news.beginning} ${news.steps} ${news.asked} ${!!news.job}`;
    if (asked !== shown.asked || news.steps !== shown.steps) {
      const heard = performance.now(), isFirst = !shown.steps && news.steps;
      shown.asked = asked;
      await refresh();
      // From the news that there is something to see until it is seen.
      if (isFirst) painted().then(() => { document.body.dataset.firstViewMs = (performance.now() - heard).toFixed(1); });
    }
    faults.update(news.study + JSON.stringify(news.running));
    diagnosis.update(`${news.diagnosis} ${news.recordings} ${news.steps} ${news.beginning}`);
  };
  events.onerror = () => { if (events.readyState === EventSource.CLOSED) tell("This session is over. Open a new one."); };
}

/* Pieces of the page */

function fill(id, html) {
  const place = $(id);
  if (shown.html.get(id) === html) return;
  // Nobody's typing is interrupted.
  const active = document.activeElement;
  if (place.contains(active) && active.matches("input.value")) return;
  if (place.contains(active) && active.matches("input.unit, .sampling input") && active.value !== active.defaultValue) return;
  const open = [...place.querySelectorAll("details[open]>summary")].map((it) => it.textContent);
  const had = [...place.querySelectorAll("details>summary")].map((it) => it.textContent);
  const focused = place.contains(active) && active.dataset ? JSON.stringify(active.dataset) : null;
  shown.html.set(id, html);
  place.innerHTML = html;
  for (const summary of place.querySelectorAll("details>summary")) {
    if (had.includes(summary.textContent)) summary.parentElement.open = open.includes(summary.textContent);
  }
  if (focused) [...place.querySelectorAll("button,select,input")].find((it) => JSON.stringify(it.dataset) === focused)?.focus();
}

function options(select, names, chosen, none) {
  const all = none ? [["", none], ...names.map((name, k) => [String(k), name])] : names.map((name, k) => [String(k), name]);
  const html = JSON.stringify([all, chosen]);
  if (select.dataset.all === html) return;
  select.dataset.all = html;
  select.replaceChildren(...all.map(([value, name]) => new Option(name, value, false, value === String(chosen ?? ""))));
}

let turn = 0;
async function refresh() {
  const mine = ++turn;
  const asked = new URLSearchParams({ step: view.step, recording: view.recording });
  // Asked for together: the numbers are many.
  const numbers = fetchSignals();
  const answer = await fetch(`${base}pieces?${asked}`).catch(() => null);
  if (!answer?.ok || mine !== turn) return;
  const said = await answer.json();
  if (said.beginning !== shown.beginning) {
    if (shown.beginning) Object.assign(view, { step: 0, ghost: null, recording: 0, window: null });
    Object.assign(shown, { beginning: said.beginning, signals: "" });
    writeAddress();
  }
  shown.steps = said.steps.length;
  const isThere = said.steps.length > 0;
  if (isThere && view.step >= said.steps.length) return look({ step: said.steps.length - 1 });
  if (view.ghost !== null && view.ghost >= said.steps.length) view.ghost = null;
  document.body.classList.toggle("begun", said.recordings.length > 0);
  for (const id of ["see", "learn", "add"]) $(id).hidden = !isThere;
  for (const [id, html] of Object.entries(said.pieces)) fill(id, html);
  document.querySelectorAll("[data-law]:not([data-tried])").forEach((it) => {
    it.dataset.tried = "";
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = "Try this law";
    button.addEventListener("click", () => tryLaw(it.dataset.target, it.dataset.law));
    it.after(" ", button);
  });
  if (!isThere) return;
  options($("recording"), said.recordings, view.recording);
  options($("ghost"), said.steps, view.ghost, "nothing");
  await draw(said.spans ?? [], numbers);
}

/* Signals */

const plots = new Plots($("plots"), (window) => brush(window));

function signalsAsked() {
  const asked = new URLSearchParams({ step: view.step, recording: view.recording });
  if (view.ghost !== null && view.ghost !== view.step) asked.set("ghost", view.ghost);
  return asked;
}

// The signals of the view, unless they are here already or there is nothing yet.
async function fetchSignals() {
  const asked = signalsAsked().toString();
  if (!shown.there || shown.signals === `${shown.beginning} ${asked}`) return null;
  const answer = await fetch(`${base}signals?${asked}`).catch(() => null);
  return answer?.ok ? { asked, data: unpacked(await answer.arrayBuffer()) } : null;
}

async function draw(spans, numbers) {
  const asked = signalsAsked().toString(), key = `${shown.beginning} ${asked}`;
  if (shown.signals !== key) {
    let got = await numbers;
    if (got?.asked !== asked) got = await fetchSignals();
    if (!got) return;
    shown.signals = key;
    shown.whole = got.data;
    shown.spans = spans;
  }
  await drawWindow();
}

// When what was drawn has been painted.
const painted = () => new Promise((done) => { requestAnimationFrame(() => setTimeout(done)); });

// The window of the address: of a recording with more samples than points it is asked for anew.
let windowTurn = 0;
async function drawWindow() {
  const mine = ++windowTurn;
  let data = shown.whole;
  if (view.window && data.bucket > 1) {
    const asked = signalsAsked();
    asked.set("from", view.window[0]);
    asked.set("to", view.window[1]);
    const answer = await fetch(`${base}signals?${asked}`);
    if (answer.ok && mine === windowTurn) data = unpacked(await answer.arrayBuffer());
  }
  if (mine !== windowTurn) return;
  const begun = performance.now();
  plots.show(data, shown.spans, view.window);
  painted().then(() => { document.body.dataset.drawnMs = (performance.now() - begun).toFixed(1); });
  const [from, to] = view.window ?? [data.time[0], data.time[data.time.length - 1]];
  $("from").value = Number(from.toPrecision(6));
  $("to").value = Number(to.toPrecision(6));
  $("zoom-out").disabled = $("earlier").disabled = $("later").disabled = !view.window;
  if ($("signal-data").open) tabulate();
  await lookWithin();
}

function brush(window) {
  view.window = window;
  writeAddress();
  drawWindow();
}

let withinTurn = 0;
async function lookWithin() {
  const mine = ++withinTurn;
  if (!view.window) { fill("within", ""); return; }
  const [from, to] = view.window;
  const asked = new URLSearchParams({ step: view.step, recording: view.recording, from, to });
  await new Promise((done) => setTimeout(done, 250));
  if (mine !== withinTurn) return;
  const answer = await fetch(`${base}within?${asked}`);
  const said = await answer.json().catch(() => ({}));
  if (mine !== withinTurn) return;
  // Another tab of this session asked later: it has its turn, then this one.
  if (answer.status === 409) { setTimeout(() => mine === withinTurn && lookWithin(), 500); return; }
  if (answer.ok) { fill("within", said.html); return; }
  const words = document.createElement("p");
  words.className = "note";
  words.textContent = `This window alone cannot be judged: ${said.problem ?? answer.status}`;
  fill("within", words.outerHTML);
}

function shift(share) {
  if (!view.window) return;
  const { time } = shown.whole, last = time[time.length - 1];
  const [from, to] = view.window, width = to - from;
  const begin = Math.min(Math.max(from + share * width, time[0]), last - width);
  brush([begin, begin + width]);
}

function tabulate() {
  const { head, rows } = plots.rows(20);
  const table = document.createElement("table");
  const headRow = table.createTHead().insertRow();
  for (const words of head) { const cell = document.createElement("th"); cell.scope = "col"; cell.textContent = words; headRow.append(cell); }
  const body = table.createTBody();
  for (const row of rows) { const line = body.insertRow(); row.forEach((value) => { line.insertCell().textContent = value; }); }
  $("signal-data").querySelector("div").replaceChildren(table);
}

/* A law of one's own */

const form = $("law");
const law = () => Object.fromEntries(new FormData(form));
let lawTurn = 0;

async function checkLaw() {
  const mine = ++lawTurn;
  await new Promise((done) => setTimeout(done, 200));
  if (mine !== lawTurn || !shown.steps) return;
  const said = await post(`law?step=${view.step}`, law());
  if (!said || mine !== lawTurn) return;
  const place = $("law-said");
  form.elements.text.setAttribute("aria-invalid", String(!!said.wrong));
  form.querySelector("[type=submit]").disabled = !!said.wrong;
  if (!said.wrong) { place.innerHTML = said.html; return; }
  const words = document.createElement("pre");
  words.className = "alert";
  const { at } = said.wrong;
  words.textContent = (at === null ? "" : `${form.elements.text.value}\n${" ".repeat(at)}^\n`) + said.wrong.words;
  place.replaceChildren(words);
}

function tryLaw(target, text) {
  form.elements.target.value = target;
  form.elements.text.value = text;
  form.elements.coefficients.value = "";
  form.closest("details").open = true;
  form.elements.text.focus();
  checkLaw();
}

/* What people do */

const faults = new Faults($("faults-content"), tell);
const diagnosis = new Diagnosis($("diagnose-content"), base, tell, mostBytes);

function goTo(name) { view.view = name; writeAddress(); showView(); }

function showView() {
  for (const name of views) $(name).hidden = view.view !== name;
  document.querySelectorAll("[data-view]").forEach((it) => it.setAttribute("aria-pressed", String(it.dataset.view === view.view)));
  faults.shown = view.view === "faults";
  if (faults.shown) faults.update("asked");
  diagnosis.shown = view.view === "diagnose";
  if (diagnosis.shown) diagnosis.update(`asked ${performance.now()}`);
}

document.addEventListener("click", async (event) => {
  const button = event.target.closest("button");
  if (!button || button.closest("#faults, #diagnose")) return;
  const { dataset } = button;
  if (dataset.view) goTo(dataset.view);
  else if (dataset.do === "example") await act({ do: "example", id: dataset.id });
  else if (dataset.do === "column") await act({ do: "column", recording: Number(dataset.recording), column: dataset.column, signal: dataset.signal, unit: dataset.unit });
  else if (["again", "resample"].includes(dataset.do)) await act({ do: dataset.do, recording: Number(dataset.recording) });
  else if (dataset.do === "remove") await act({ do: "remove", recording: Number(dataset.recording) });
  else if (dataset.do === "add") await act({ do: "add", step: view.step, effect: dataset.effect });
  else if (["fit", "learn"].includes(dataset.do)) await act({ do: dataset.do, step: view.step });
  else if (dataset.do === "cancel") { status(null); await act({ do: "cancel" }); }
  else if (dataset.goto) await look({ step: Number(dataset.goto), ghost: null });
  else if (dataset.ghost) await look({ ghost: Number(dataset.ghost) });
  else if (dataset.from) {
    const from = Number(dataset.from), to = Number(dataset.to), room = Math.max(0.5 * (to - from), 0.05);
    $("plots").scrollIntoView({ block: "start" });
    brush([Math.max(from - room, shown.whole.time[0]), to + room]);
  } else if (dataset.copy) {
    const text = $(dataset.copy).textContent;
    try { await navigator.clipboard.writeText(text); button.textContent = "Copied"; }
    catch { getSelection().selectAllChildren($(dataset.copy)); button.textContent = "Selected"; }
  } else if (button.id === "zoom-out") brush(null);
  else if (button.id === "earlier") shift(-0.5);
  else if (button.id === "later") shift(0.5);
});

document.addEventListener("change", async (event) => {
  const { target } = event;
  if (target.id === "file") { await upload(target.files); target.value = ""; }
  else if (target.id === "recording") await look({ recording: Number(target.value), window: null });
  else if (target.id === "ghost") await look({ ghost: target.value === "" ? null : Number(target.value) });
  else if (target.id === "from" || target.id === "to") {
    const from = Number($("from").value), to = Number($("to").value);
    if (from < to) brush([from, to]); else tell("A window begins before it ends.");
  } else if (target.matches("select.signal, input.unit")) {
    const row = target.closest("tr");
    const signal = row.querySelector(".signal").value, unit = row.querySelector(".unit")?.value ?? "";
    // Said: what is shown may follow.
    if (target.matches("input")) target.defaultValue = target.value;
    await act({ do: "column", recording: Number(row.dataset.recording), column: row.dataset.column, signal, unit });
  } else if (target.matches("input.value")) {
    const value = Number(target.value.replace("\u2212", "-").replace(",", "."));
    if (target.value.trim() === "" || !Number.isFinite(value)) { tell(`${target.dataset.parameter}: "${target.value}" is no number.`); return; }
    target.blur();
    await act({ do: "set", step: view.step, name: target.dataset.parameter, value });
  }
});

document.addEventListener("submit", async (event) => {
  const asked = event.target.closest("form.sampling");
  if (!asked) return;
  event.preventDefault();
  const input = asked.elements.ms, ms = Number(input.value.replace(",", "."));
  if (!(ms > 0)) { tell(`"${input.value}" is no time in ms.`); return; }
  input.defaultValue = input.value;
  await act({ do: asked.dataset.what, recording: Number(asked.dataset.recording), ms });
});

form.addEventListener("input", checkLaw);
form.addEventListener("submit", async (event) => { event.preventDefault(); await act({ do: "law", step: view.step, law: law() }); });
form.closest("details").addEventListener("toggle", checkLaw);
$("signal-data").addEventListener("toggle", () => { if ($("signal-data").open) tabulate(); });
// A tab that nobody sees keeps no connection: a browser has few for a server.
document.addEventListener("visibilitychange", () => { events?.close(); if (!document.hidden) listen(); });
addEventListener("hashchange", () => { readAddress(); showView(); refresh(); });

// Files may be dropped anywhere.
const carries = (event) => event.dataTransfer?.types.includes("Files");
addEventListener("dragover", (event) => { if (carries(event)) { event.preventDefault(); document.body.classList.add("dropping"); } });
addEventListener("dragleave", (event) => { if (!event.relatedTarget) document.body.classList.remove("dropping"); });
addEventListener("drop", async (event) => {
  if (!carries(event)) return;
  event.preventDefault();
  document.body.classList.remove("dropping");
  if (view.view === "faults") { await faults.file(event.dataTransfer.files[0]); return; }
  if (view.view === "diagnose") { await diagnosis.dropped(event); return; }
  await upload(event.dataTransfer.files);
});

tell();
status(null);
readAddress();
showView();
listen();
