// Unpacks the libraries of the page, then draws its plots and snapshots; draws the plots again when light turns to dark.
"use strict";
(() => {
  const themes = JSON.parse(document.getElementById("themes").textContent);
  const root = document.documentElement;
  const dark = window.matchMedia("(prefers-color-scheme: dark)");
  const views = [];
  const theme = () => root.dataset.theme;

  async function unpack(script) {
    const bytes = Uint8Array.from(atob(script.textContent), (c) => c.charCodeAt(0));
    const text = await new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).text();
    const element = document.createElement("script");
    element.text = text;
    script.replaceWith(element);
  }

  function button(text, action, parent) {
    const made = document.createElement("button");
    made.type = "button";
    made.textContent = text;
    made.addEventListener("click", () => action(made));
    parent.append(made);
    return made;
  }

  // ------------------------------------------------------------------ plots ---
  const tip = document.createElement("div");
  tip.className = "tip";
  tip.hidden = true;

  function showTip(handler, event, item, value) {
    if (value === null || value === undefined || value === "") {
      tip.hidden = true;
      return;
    }
    tip.replaceChildren();
    const pairs = typeof value === "object" ? Object.entries(value) : [["", value]];
    for (const [name, text] of pairs) {
      const line = document.createElement("div");
      const label = document.createElement("b");
      label.textContent = name ? name + "  " : "";
      line.append(label, String(text));
      tip.append(line);
    }
    tip.hidden = false;
    const box = tip.getBoundingClientRect();
    tip.style.left = Math.max(4, Math.min(event.clientX + 14, innerWidth - box.width - 6)) + "px";
    tip.style.top = Math.max(4, event.clientY - box.height - 14) + "px";
  }

  function compile(plot, name, width) {
    const spec = { ...plot.spec, width, height: plot.height, autosize: { type: "fit", contains: "padding" },
      config: { ...themes[name], ...(name === "light" && width !== "container" ? { background: "white" } : {}) } };
    return vega.parse(vegaLite.compile(spec).spec);
  }

  async function draw(place) {
    place.view?.finalize();
    place.view = new vega.View(compile(place.plot, theme(), "container"), { renderer: "canvas", container: place.canvas, hover: true })
      .tooltip(showTip).logLevel(vega.Error);
    await place.view.runAsync();
  }

  function download(name, url) {
    const link = document.createElement("a");
    link.href = url;
    link.download = name;
    link.click();
  }

  async function save(plot, form) {
    const view = new vega.View(compile(plot, "light", 560), { renderer: "none" });
    await view.runAsync();
    const url = form === "svg" ? URL.createObjectURL(new Blob([await view.toSVG()], { type: "image/svg+xml" })) : await view.toImageURL("png", 2);
    download(plot.name + "." + form, url);
    view.finalize();
  }

  async function makePlot(place) {
    place.plot = JSON.parse(place.querySelector("script").textContent);
    place.canvas = document.createElement("div");
    place.canvas.style.width = "100%";
    place.append(place.canvas);
    views.push(place);
    await draw(place);
    const row = document.createElement("div");
    row.className = "save";
    for (const form of ["svg", "png"]) button(form.toUpperCase(), () => save(place.plot, form), row);
    place.after(row);
  }

  // -------------------------------------------------------------- snapshots ---
  const array = (Kind, text) => new Kind(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);

  function makeViewer(place) {
    const probe = document.createElement("canvas");
    if (!(probe.getContext("webgl2") || probe.getContext("webgl"))) throw new Error("this browser has no WebGL");
    const data = JSON.parse(place.querySelector("script").textContent);
    const raw = array(Uint16Array, data.position), kind = array(Uint16Array, data.kind), bonds = array(Uint32Array, data.bonds);
    const ids = data.id ? array(Uint32Array, data.id) : null;
    const at = (i) => [raw[3 * i] * data.grid, raw[3 * i + 1] * data.grid, raw[3 * i + 2] * data.grid];
    const toward = new Map(data.crossing.map((k, i) => [k, data.toward[i]]));
    const hidden = new Set();
    const look = { style: bonds.length ? "sticks" : "balls", box: true };
    const stage = document.createElement("div");
    stage.className = "stage";
    place.append(stage);
    const viewer = $3Dmol.createViewer(stage, { backgroundAlpha: 0, backgroundColor: "white", antialias: true, orthographic: data.flat, disableFog: data.flat,
      cartoonQuality: 1 });

    function model() {
      const radius = { sticks: 0.24, balls: 0.36, full: 0.5 }[look.style] * data.spacing;
      const colours = data.kinds.map((k) => k[1]);
      const atoms = [];
      for (let i = 0; i < data.n; i++) {
        const [x, y, z] = at(i), k = kind[i];
        atoms.push({ x, y, z, elem: "X", index: i, serial: i, color: colours[k], bonds: [], bondOrder: [], hidden: hidden.has(k),
          style: hidden.has(k) ? {} : { sphere: { radius: radius * data.kinds[k][2], color: colours[k] } } });
      }
      const stick = { stick: { radius: Math.min(0.11 * data.spacing, 0.6 * radius) } };
      const join = (i, j) => {
        atoms[i].bonds.push(j); atoms[j].bonds.push(i);
        atoms[i].bondOrder.push(1); atoms[j].bondOrder.push(1);
      };
      // the half of a bond that leaves the box ends at an atom that is not shown
      const stub = (i, j, move, sign) => {
        const [a, b] = [at(i), at(j)];
        const end = a.map((c, k) => c + 0.5 * (b[k] + sign * move[k] - c));
        atoms.push({ x: end[0], y: end[1], z: end[2], elem: "X", index: atoms.length, serial: atoms.length, color: atoms[i].color, bonds: [], bondOrder: [],
          style: { stick: { ...stick.stick, color: atoms[i].color } } });
        join(i, atoms.length - 1);
      };
      if (look.style !== "full") {
        for (let b = 0; 2 * b < bonds.length; b++) {
          const i = bonds[2 * b], j = bonds[2 * b + 1];
          if (atoms[i].hidden || atoms[j].hidden) continue;
          if (toward.has(b)) {
            stub(i, j, toward.get(b), 1);
            stub(j, i, toward.get(b), -1);
          } else join(i, j);
        }
        for (const a of atoms) if (a.bonds.length && a.style.sphere) a.style.stick = { ...stick.stick, color: a.color };
      }
      return atoms;
    }

    function build() {
      viewer.removeAllModels();
      viewer.removeAllShapes();
      const atoms = model();
      const made = viewer.addModel();
      made.addAtoms(atoms);
      if (look.box) {
        const color = theme() === "dark" ? "#8b98a6" : "#6b7885";
        const point = (k) => ({ x: data.corners[k][0], y: data.corners[k][1], z: data.corners[k][2] });
        for (const [a, b] of data.edges) viewer.addCylinder({ start: point(a), end: point(b), radius: 0.0025 * 60, color, fromCap: 2, toCap: 2 });
      }
      viewer.render();
    }

    // z points up, the box is turned a little; in two dimensions x and y lie in the picture
    function aim() {
      const half = (degrees) => (degrees * Math.PI) / 360;
      const [a, b] = data.flat ? [0, 0] : [half(-76), half(-24)];
      const turn = [Math.sin(a) * Math.cos(b), -Math.sin(a) * Math.sin(b), Math.cos(a) * Math.sin(b), Math.cos(a) * Math.cos(b)];
      viewer.setView([0, 0, 0, 0, ...turn]);
      viewer.zoomTo();
      const view = viewer.getView();
      viewer.setView([...data.centre.map((c) => -c), view[3], ...view.slice(4)]);
      viewer.zoom(Math.min(1, stage.clientWidth / stage.clientHeight) * (data.flat ? 1.0 : 1.2));
      viewer.render();
    }

    build();
    aim();
    views.push({ redraw: build });
    // the wheel scrolls the page until the picture was touched
    let active = false, touched = false;
    stage.addEventListener("pointerdown", () => { active = touched = true; });
    stage.addEventListener("pointerleave", () => { active = false; });
    stage.addEventListener("wheel", (event) => { if (!active) event.stopImmediatePropagation(); }, { capture: true });
    new ResizeObserver(() => {
      viewer.resize();
      if (!touched) aim();
    }).observe(stage);

    const legend = document.createElement("div");
    legend.className = "legend";
    data.kinds.forEach(([name, colour, , count], k) => {
      const made = button("", (self) => {
        hidden.has(k) ? hidden.delete(k) : hidden.add(k);
        self.setAttribute("aria-pressed", String(!hidden.has(k)));
        build();
      }, legend);
      const dot = document.createElement("i");
      dot.style.background = colour;
      const number = document.createElement("small");
      number.textContent = count.toLocaleString("en");
      made.append(dot, name, number);
      made.setAttribute("aria-pressed", "true");
    });
    const tools = document.createElement("div");
    tools.className = "tools";
    const names = bonds.length ? [["sticks", "Balls and sticks"], ["full", "Space filling"]] : [["balls", "Balls"], ["full", "Space filling"]];
    const styles = names.map(([style, text]) => button(text, () => {
      look.style = style;
      for (const [k, b] of styles.entries()) b.setAttribute("aria-pressed", String(names[k][0] === style));
      build();
    }, tools));
    styles[0].setAttribute("aria-pressed", "true");
    button("Box", (self) => { look.box = !look.box; self.setAttribute("aria-pressed", String(look.box)); build(); }, tools).setAttribute("aria-pressed", "true");
    let spinning = false;
    if (!data.flat) button("Spin", (self) => { spinning = !spinning; self.setAttribute("aria-pressed", String(spinning)); viewer.spin(spinning ? "y" : false, 0.5); }, tools);
    button("Reset", aim, tools);
    button("PNG", () => download("snapshot.png", viewer.pngURI()), tools);
    if (data.of > data.n) {
      const text = document.createElement("p");
      text.className = "note";
      text.textContent = `${data.n.toLocaleString("en")} of ${data.of.toLocaleString("en")} atoms are shown.`;
      place.append(legend, tools, text);
    } else place.append(legend, tools);
  }

  // ------------------------------------------------------------------- page ---
  function failed(place, error) {
    const text = document.createElement("div");
    text.className = "failed";
    text.textContent = "This could not be drawn: " + error.message;
    place.append(text);
    console.error(error);
  }

  async function setTheme(name) {
    root.dataset.theme = name;
    for (const view of views) view.redraw ? view.redraw() : await draw(view);
  }

  async function start() {
    root.dataset.theme = dark.matches ? "dark" : "light";
    document.body.append(tip);
    document.getElementById("theme").addEventListener("click", () => setTheme(theme() === "dark" ? "light" : "dark"));
    dark.addEventListener("change", () => setTheme(dark.matches ? "dark" : "light"));
    window.addEventListener("scroll", () => { tip.hidden = true; }, { passive: true });
    for (const script of document.querySelectorAll("script[data-library]")) await unpack(script);
    for (const place of document.querySelectorAll(".figure")) await makePlot(place).catch((error) => failed(place, error));
    for (const place of document.querySelectorAll(".molecule")) {
      try { makeViewer(place); } catch (error) { failed(place, error); }
    }
    root.dataset.ready = "yes";
  }

  start().catch((error) => failed(document.querySelector("main"), error));
})();
