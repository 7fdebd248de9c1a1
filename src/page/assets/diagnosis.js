// The view of training and diagnosing: what the server drew, and what people do there.

export class Diagnosis {
  constructor(place, base, tell, mostBytes) {
    Object.assign(this, { place, base, tell, mostBytes, version: "", shown: false });
    place.addEventListener("click", (event) => this.clicked(event));
    place.addEventListener("change", (event) => this.changed(event));
  }

  async post(body) {
    this.tell();
    const answer = await fetch(`${this.base}diagnosis`, { method: "POST", body: JSON.stringify(body), headers: { "content-type": "application/json" } });
    if (!answer.ok) this.tell((await answer.json().catch(() => ({}))).problem ?? `The server answered ${answer.status}.`);
  }

  async files(files, healthy) {
    this.tell();
    for (const file of files) {
      if (file.size > this.mostBytes) { this.tell(`${file.name} has ${Math.ceil(file.size / 1e6)} MB, and ${this.mostBytes / 1e6} MB are taken: keep fewer rows or columns.`); return; }
      const answer = await fetch(`${this.base}diagnosis/file?name=${encodeURIComponent(file.name)}&healthy=${healthy}`, { method: "POST", body: file }).catch(() => null);
      if (!answer?.ok) { this.tell((await answer?.json().catch(() => ({})))?.problem ?? `${file.name} did not arrive.`); return; }
    }
  }

  // Files that were dropped: into a zone, or else to be watched once there is something to train on.
  dropped(event) {
    const zone = event.target.closest?.("[data-healthy]");
    const some = this.place.querySelector('select[data-diagnose="mark"]');
    return this.files(event.dataTransfer.files, zone ? zone.dataset.healthy === "true" : !some);
  }

  async clicked(event) {
    const button = event.target.closest("button");
    if (!button) return;
    const { diagnose, name, recording, healthy } = button.dataset;
    if (diagnose === "take") await this.post({ do: "take", recording: Number(recording), healthy: healthy === "true" });
    else if (diagnose === "remove") await this.post({ do: "remove", name });
    else if (diagnose === "train" || diagnose === "judge") await this.post({ do: diagnose });
  }

  async changed({ target }) {
    if (target.matches("input[type=file]")) { await this.files(target.files, target.dataset.healthy === "true"); target.value = ""; }
    else if (target.dataset.diagnose === "mark") await this.post({ do: "mark", name: target.dataset.name, healthy: target.value === "true" });
    else if (target.dataset.diagnose === "drive") await this.post({ do: "drive", step: target.value === "" ? null : Number(target.value) });
  }

  // Draws again if something changed; what has the keyboard keeps it.
  async update(version) {
    if (!this.shown || version === this.version) return;
    const answer = await fetch(`${this.base}diagnosis`).catch(() => null);
    if (!answer?.ok) return;
    const said = await answer.json();
    this.version = version;
    const active = document.activeElement, key = this.place.contains(active) ? active.id || JSON.stringify(active.dataset) : null;
    const open = this.place.querySelector("details[open]");
    this.place.innerHTML = said.html;
    if (open) this.place.querySelector("details")?.setAttribute("open", "");
    if (key) [...this.place.querySelectorAll("button,select,input")].find((it) => (it.id || JSON.stringify(it.dataset)) === key)?.focus();
  }
}
