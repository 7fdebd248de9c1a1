// The faults view: what the server drew of a study.

export class Faults {
  constructor(place, tell) {
    this.place = place;
    this.tell = tell;
    this.version = 0;
    this.shown = false;
    place.addEventListener("click", (event) => this.clicked(event));
    place.addEventListener("change", (event) => {
      if (event.target.id === "study-file" && event.target.files.length) this.file(event.target.files[0]);
    });
  }

  async post(url, body) {
    const answer = await fetch(url, { method: "POST", body, headers: typeof body === "string" ? { "content-type": "application/json" } : {} });
    if (!answer.ok) this.tell((await answer.json().catch(() => ({}))).problem ?? `the server answered ${answer.status}`);
  }

  file(file) { return this.post("/study/file", file); }

  async clicked(event) {
    // The address holds the view, so that a place in it is gone to without it.
    const link = event.target.closest('a[href^="#"]');
    if (link) {
      event.preventDefault();
      document.getElementById(link.getAttribute("href").slice(1))?.scrollIntoView();
      return;
    }
    const button = event.target.closest("button[data-study]");
    if (button) await this.post("/study", JSON.stringify({ do: button.dataset.study }));
  }

  // Draws again if something changed.
  async update(version) {
    if (!this.shown || version === this.version) return;
    const answer = await fetch("/study");
    if (!answer.ok) return;
    const said = await answer.json();
    this.version = said.version;
    this.place.innerHTML = said.html;
  }
}
