// Draws the interactive figures from the JSON beside each of them; tables sort by their headings.
(() => {
  "use strict";

  // "1,2,,4" is numbers, {of, at} texts of which each different one is kept once.
  function column(given) {
    if (typeof given === "string") {
      return given.split(",").map((text) => (text === "" ? null : Number(text)));
    }
    return column(given.at).map((place) => (place === null ? null : given.of[place]));
  }

  function rowsOf(axes, columns) {
    const known = Object.entries(columns).map(([name, given]) => [name, column(given)]);
    const count = axes.reduce((product, axis) => product * axis.texts.length, 1);
    return Array.from({ length: count }, (_, at) => {
      const row = {};
      let rest = at;
      for (const axis of axes.toReversed()) {
        const place = rest % axis.texts.length;
        rest = Math.floor(rest / axis.texts.length);
        for (const known of [axis, ...(axis.companions ?? [])]) {
          row[known.name] = known.values ? known.values[place] : known.texts[place];
          row[`${known.name}_text`] = known.texts[place];
          row[`${known.name}_at`] = place;
        }
      }
      for (const [name, values] of known) row[name] = values[at];
      return row;
    });
  }

  function put(spec, pointer, value) {
    const keys = pointer.split("/").slice(1);
    const last = keys.pop();
    const place = keys.reduce((at, key) => at[key], spec);
    if (value === null) delete place[last];
    else place[last] = value;
  }

  class Figure {
    constructor(holder) {
      this.holder = holder;
      this.plot = holder.querySelector(".plot");
      const given = JSON.parse(holder.querySelector("script").textContent);
      Object.assign(this, given);
      this.inputs = [...holder.querySelectorAll("[data-control]")];
      this.switches = [...holder.querySelectorAll("[data-switch]")];
      this.rows = rowsOf(given.axes, given.columns);
      for (const input of this.inputs) input.addEventListener("input", () => this.follow());
      for (const box of this.switches) box.addEventListener("change", () => this.follow());
      for (const button of holder.querySelectorAll("[data-all]")) {
        button.addEventListener("click", () => {
          for (const box of this.switches) box.checked = button.dataset.all === "on";
          this.follow();
        });
      }
    }

    // What the inputs ask for: signals of the drawn figure, and parts of its specification.
    wanted() {
      const options = this.inputs.map((input) => {
        const place = input.type === "checkbox" ? Number(input.checked) : Number(input.value);
        return this.controls[input.dataset.control][place];
      });
      const off = new Set(options.flatMap((option) => option.disables));
      const signals = { shown: this.switches.filter((b) => b.checked).map((b) => b.value) };
      const patches = [];
      this.inputs.forEach((input, at) => {
        input.disabled = off.has(input.dataset.control);
        if (input.type === "range") {
          input.setAttribute("aria-valuetext", options[at].label);
          input.parentElement.querySelector("output").textContent = options[at].label;
        }
        if (!off.has(input.dataset.control)) patches.push(...Object.entries(options[at].patches));
        Object.assign(signals, options[at].signals);
      });
      return { signals, patches };
    }

    // Draws what the inputs ask for, one request after the other; meanwhile the holder says so.
    async follow() {
      this.holder.dataset.state = "drawing";
      this.asked = true;
      if (this.busy) return;
      this.busy = true;
      try {
        while (this.asked) {
          this.asked = false;
          await this.show();
        }
        this.holder.dataset.state = "drawn";
      } finally {
        this.busy = false;
      }
    }

    async show() {
      const { signals, patches } = this.wanted();
      const key = JSON.stringify(patches);
      if (this.view && key === this.key) {
        for (const [name, value] of Object.entries(signals)) this.view.signal(name, value);
        await this.view.runAsync();
        return;
      }
      this.key = key;
      const spec = structuredClone(this.spec);
      for (const [pointer, value] of patches) put(spec, pointer, value);
      for (const parameter of spec.params) {
        if (parameter.name in signals) parameter.value = signals[parameter.name];
      }
      spec.datasets = { rows: this.rows, one: [{}] };
      const options = { renderer: "svg", actions: false, tooltip: { theme: "light" } };
      const former = this.drawn;
      this.drawn = await vegaEmbed(this.plot, spec, options);
      this.view = this.drawn.view;
      former?.finalize();
      this.plot.querySelector("svg").setAttribute("aria-hidden", "true");
    }
  }

  async function draw(holder) {
    try {
      await new Figure(holder).follow();
    } catch (error) {
      holder.dataset.state = "failed";
      holder.querySelector(".plot").textContent = `This figure cannot be drawn here: ${error}`;
    }
  }

  const collator = new Intl.Collator("en", { numeric: true });

  function keyOf(cell) {
    const given = cell.dataset.value ?? cell.textContent.replaceAll("−", "-");
    const value = given === "" ? NaN : Number.parseFloat(given);
    return Number.isNaN(value) ? cell.textContent : value;
  }

  function compare(one, other) {
    if (typeof one === "number" && typeof other === "number") return one - other;
    if (typeof one === "number") return -1;
    if (typeof other === "number") return 1;
    return collator.compare(one, other);
  }

  function sortBy(heading) {
    const table = heading.closest("table");
    const down = heading.getAttribute("aria-sort") === "ascending";
    for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
    heading.setAttribute("aria-sort", down ? "descending" : "ascending");
    const body = table.tBodies[0];
    const at = heading.cellIndex;
    const keyed = [...body.rows].map((row) => [keyOf(row.cells[at]), row]);
    keyed.sort(([one], [other]) => (down ? compare(other, one) : compare(one, other)));
    body.append(...keyed.map(([, row]) => row));
  }

  for (const button of document.querySelectorAll("th button")) {
    button.addEventListener("click", () => sortBy(button.closest("th")));
  }

  // Nothing is folded away on paper.
  addEventListener("beforeprint", () => {
    for (const details of document.querySelectorAll("details:not([open])")) {
      details.open = true;
      addEventListener("afterprint", () => (details.open = false), { once: true });
    }
  });

  (async () => {
    for (const holder of document.querySelectorAll(".interactive")) {
      await draw(holder);
      await new Promise((go) => setTimeout(go));
    }
    performance.mark("figures drawn");
    document.documentElement.dataset.figures = "drawn";
  })();
})();
