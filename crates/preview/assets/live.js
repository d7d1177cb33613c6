// The page of `isoslice watch`. It asks the program for the model's state,
// shows it, and sends what its user changes.

// Share of the window's pixels, along a side, in pictures while they turn.
const ROUGH = 0.3;
// Greatest side of a picture, pixels.
const LARGEST = 1600;
// Time for which a layer is shown before the program is told of it, milliseconds.
const LOOKED = 100;
// A height above every part, mm.
const TOP = 1e6;
// Time until a program that does not answer is asked again, milliseconds.
const AGAIN = 1000;

const signalled = controller => controller?.signal.aborted ?? false;

class Live {
  constructor() {
    // The state that the program sent last.
    this.told = null;
    // The revisions of the parts of that state that the page has.
    this.has = { model: 0, print: 0, glimpse: 0, settings: 0 };
    // The view that the user has chosen, and whether an older model may be
    // shown in it.
    this.view = "layers";
    this.impatient = false;
    this.drawing = false;
    this.asked = "";
    this.changes = null;
    this.changing = false;
    // The height of the layer that the program knows to be shown.
    this.layerTold = null;
    this.layerTimer = 0;
  }

  async begin() {
    const press = (group, what) => {
      for (const button of $(group).children) {
        button.addEventListener("click", () => what(button.dataset));
      }
    };
    press("tabs", ({ tab }) => this.openTab(tab));
    press("views", ({ view }) => {
      this.view = view;
      this.impatient = view === "layers";
      this.showView();
    });
    // The parts of the page of `preview` are one of the tabs here.
    for (const id of ["modes", "scale", "amounts", "roles", "cut"]) {
      $(id).classList.add("of-print");
    }
    this.openTab("model");
    const search = () => this.filterSettings();
    $("search").addEventListener("input", search);
    $("only-changed").addEventListener("change", search);
    $("send-store").addEventListener("click", () => this.send(false));
    $("send-start").addEventListener("click", () => this.send(true));
    setTheme(remembered() ?? (prefersDark.matches ? "dark" : "light"));
    $("notice").textContent = "Reading the model …";
    for (;;) {
      await this.follow();
    }
  }

  openTab(tab) {
    for (const button of $("tabs").children) {
      button.setAttribute("aria-pressed", button.dataset.tab === tab);
    }
    for (const page of document.querySelectorAll("[data-page]")) {
      page.hidden = page.dataset.page !== tab;
    }
    document.documentElement.dataset.tab = tab;
    // The panel is as high as what is on it.
    if (camera) {
      placeView();
    }
  }

  // Waits for new states, and shows them.
  async follow() {
    try {
      const seen = this.told?.revision ?? 0;
      const answer = await fetch(`state?seen=${seen}`);
      if (!answer.ok) {
        throw new Error(await answer.text());
      }
      this.told = await answer.json();
      await this.showNews();
    } catch (error) {
      document.documentElement.dataset.state = "gone";
      this.allow(false);
      this.sayFault("isoslice does not answer: if it has ended, start it "
        + "again, and open the address that it shows", error.message);
      await new Promise(resolve => setTimeout(resolve, AGAIN));
    }
  }

  async showNews() {
    const { has, told: news } = this;
    const { model, print, glimpse, fault, busy, progress } = news;
    $("busy").hidden = !busy;
    const [done, all] = progress;
    $("busy").firstChild.style.width = `${all > 0 ? 100 * done / all : 2}%`;
    if (busy) {
      $("summary").textContent = all > 0
        ? `${busy}, layer ${done} of ${all}` : busy;
    }
    if (model && model.revision !== has.model) {
      has.model = model.revision;
      this.impatient = false;
      if (camera) {
        camera.hold(model.box);
      } else {
        begin(model.box);
        $("notice").hidden = true;
      }
      this.asked = "";
      this.listParameters();
    }
    this.listProfiles();
    if (news.settings !== has.settings) {
      has.settings = news.settings;
      await this.listSettings();
    }
    if (print && print.revision !== has.print) {
      await this.fetchPrint(print);
    } else if (glimpse && told && glimpse.revision !== has.glimpse) {
      await this.fetchGlimpse(glimpse);
    } else if (!busy && told) {
      listFigures();
    }
    this.sayWarnings();
    this.listPrinters();
    const current = Boolean(print) && !busy && !fault;
    this.allow(current);
    if (fault) {
      this.sayFault(fault.text, fault.excerpt);
      $("notice").hidden = true;
    } else {
      $("fault").hidden = true;
    }
    const state = fault ? "wrong" : busy ? "busy" : "done";
    document.documentElement.dataset.state = state;
    this.showView();
  }

  // Lets the user save and send the print that is shown, or not.
  allow(can) {
    const save = $("save-gcode");
    save.setAttribute("aria-disabled", !can);
    const { print, sending } = this.told ?? {};
    if (can) {
      save.href = `gcode?print=${print.revision}`;
      save.download = print.file;
    } else {
      save.removeAttribute("href");
    }
    $("send-store").disabled = $("send-start").disabled =
      !can || sending.busy;
  }

  // Tells the program what the user looks at now.
  looked() {
    const layers = told && this.view === "layers" && !this.has.glimpse;
    if (layers) {
      // Whoever looks at the top looks at the next part's top, too.
      const { high } = layerSlider;
      this.looksAt(high < layerCount - 1 ? told.z[high] : TOP);
    } else if (this.view === "part") {
      this.looksAt(null);
    }
  }

  // Shows the layers, if the part's picture is shown now.
  showLayers() {
    this.view = "layers";
    this.impatient = true;
    this.showView();
  }

  // Tells the program which layer is shown, once the slider rests. It makes that
  // one first when the part changes.
  looksAt(layer) {
    clearTimeout(this.layerTimer);
    this.layerTimer = setTimeout(async () => {
      if (layer !== this.layerTold) {
        this.layerTold = layer;
        await this.post("layer", JSON.stringify({ layer })).catch(() => {});
      }
    }, LOOKED);
  }

  // A line of the G-code that is shown.
  async line(number) {
    // There is no file of a single layer.
    if (this.has.glimpse) {
      return "";
    }
    try {
      const answer = await fetch(`line?print=${this.has.print}&line=${number}`);
      return answer.ok ? await answer.text() : "";
    } catch {
      return "";
    }
  }

  sayFault(text, excerpt) {
    $("fault").hidden = false;
    $("fault").querySelector("b").textContent = text;
    $("fault").querySelector("pre").textContent = excerpt;
  }

  async fetchPrint(print) {
    const made = await this.fetchMoves("print", print.revision);
    if (made) {
      await show(...made);
      this.has.print = print.revision;
      this.has.glimpse = 0;
    }
  }

  // Shows one layer of a part that is still being sliced. The others have no
  // moves yet; their heights are as if the first one were as high as before and
  // all others equally high.
  async fetchGlimpse(glimpse) {
    const made = await this.fetchMoves("glimpse", glimpse.revision);
    if (!made) {
      return;
    }
    const [data, packed] = made;
    const { layer, layers } = glimpse;
    const [start, z, time] = [data.first[0], data.z[0], data.time[0]];
    const each = what => Array.from({ length: layers }, (_, i) => what(i));
    data.first = each(i => i <= layer ? start : data.moves);
    const foot = Math.min(told.z[0], z);
    const step = layer > 0 ? (z - foot) / layer : z;
    data.z = each(i => z + (i - layer) * step);
    data.time = each(i => i === layer ? time : 0);
    // The tables go on telling of the last part that was sliced.
    data.statistics = { ...figures, printed: this.told.model.box };
    await show(data, packed, true);
    this.has.glimpse = glimpse.revision;
  }

  // The moves and what is told of them; none if there are newer ones, of which a
  // new state will tell.
  async fetchMoves(path, revision) {
    const answer = await fetch(`${path}?revision=${revision}`);
    if (!answer.ok) {
      return null;
    }
    const bytes = new Uint8Array(await answer.arrayBuffer());
    const end = bytes.indexOf(10);
    const told = JSON.parse(new TextDecoder().decode(bytes.subarray(0, end)));
    return [told, bytes.subarray(end + 1)];
  }

  // --- the part's picture

  // True if the part's picture is shown, and not its layers.
  get showsPart() {
    const { told: news, has } = this;
    if (!news?.model || this.view === "part") {
      return Boolean(news?.model);
    }
    // One layer is not what is left of a part when the script is wrong.
    if (news.fault && has.glimpse && !this.impatient) {
      return true;
    }
    // The layers of an older model are not shown in a newer one's place.
    const newest = news.glimpse ?? news.print;
    return has.print === 0 || !this.impatient
      && newest?.of_model !== news.model.revision;
  }

  showView() {
    const part = this.showsPart;
    const page = document.documentElement;
    const before = page.dataset.shows;
    page.dataset.shows = part ? "part" : "layers";
    this.looked();
    for (const button of $("views").children) {
      button.setAttribute(
        "aria-pressed", (button.dataset.view === "part") === part);
    }
    if (part) {
      this.turned(false);
    } else {
      $("picture").hidden = true;
      if (before !== "layers") {
        redraw(false);
      }
    }
  }

  // The camera has moved.
  turned(brisk) {
    if (camera && this.showsPart) {
      this.brisk = brisk;
      if (brisk) {
        // A fine picture that is still being drawn would come too late, so it
        // is given up.
        this.finePicture?.abort();
      }
      this.draw();
    }
  }

  // One picture is drawn at a time, from where the camera is when it is asked
  // for.
  async draw() {
    if (this.drawing) {
      return;
    }
    const canvas = $("view");
    const [left, top] = [2 * camera.aside + 20, HEAD];
    // A panel below the picture begins as far from the window's bottom.
    const bottom = camera.above > 0 ? top + 2 * camera.above : 30;
    const room = [
      Math.max(80, canvas.clientWidth - left - 20),
      Math.max(80, canvas.clientHeight - top - bottom),
    ];
    Object.assign($("picture").style, {
      left: `${left}px`, top: `${top}px`,
      width: `${room[0]}px`, height: `${room[1]}px`,
    });
    // The first picture of a new part is a rough one, too.
    const known = $("picture").dataset.model === String(this.has.model);
    const rough = this.brisk || !known;
    const density = rough ? ROUGH : Math.min(2, devicePixelRatio || 1);
    const fit = Math.min(1, LARGEST / (density * Math.max(...room)));
    const [width, height] = room.map(side => Math.round(side * density * fit));
    const degrees = angle => (angle * 180 / Math.PI).toFixed(2);
    const of = this.has.model;
    const wanted = `picture?model=${of}&width=${width}`
      + `&height=${height}&azimuth=${degrees(camera.yaw % (2 * Math.PI))}`
      + `&elevation=${degrees(camera.pitch)}&rough=${rough ? 1 : 0}`;
    if (wanted === this.asked) {
      $("picture").hidden = !this.showsPart;
      return;
    }
    this.drawing = true;
    this.asked = wanted;
    this.finePicture = rough ? null : new AbortController();
    let again = 0;
    try {
      const signal = this.finePicture?.signal;
      const answer = await fetch(wanted, { signal });
      if (!answer.ok) {
        this.asked = "";
        again = AGAIN;
      } else {
        const url = URL.createObjectURL(await answer.blob());
        const before = $("picture").src;
        $("picture").src = url;
        await $("picture").decode();
        $("picture").hidden = !this.showsPart;
        $("picture").dataset.model = of;
        URL.revokeObjectURL(before);
      }
    } catch {
      // The picture is no longer wanted, or the program has ended. `follow`
      // tells of that.
      this.asked = "";
      again = signalled(this.finePicture) ? 0 : AGAIN;
    }
    this.drawing = false;
    // The next picture is from where the camera is now, and a fine one once the
    // camera rests.
    if (rough) {
      this.brisk = false;
      again = 120;
    }
    if (again > 0) {
      setTimeout(() => this.turned(this.brisk), again);
    } else {
      this.turned(this.brisk);
    }
  }

  // --- what the user changes

  // Changes are sent one after the other. Those made while one is being sent
  // are sent together.
  async change(kind, name, value) {
    this.changes ??= {};
    if (kind === "profile") {
      this.changes[name] = value;
    } else {
      (this.changes[kind] ??= {})[name] = value;
    }
    if (this.changing) {
      return;
    }
    this.changing = true;
    while (this.changes) {
      const body = JSON.stringify(this.changes);
      this.changes = null;
      try {
        await this.post("change", body);
      } catch (error) {
        this.sayFault(error.message, "");
      }
    }
    this.changing = false;
  }

  async post(path, body) {
    const answer = await fetch(path, {
      method: "POST",
      headers: { "Content-Type": "application/json" },
      body,
    });
    if (!answer.ok) {
      throw new Error(await answer.text());
    }
  }

  // A line of the form: a name, the field that sets it, and a remark.
  field(name, input, words, changed, back) {
    const field = element("label", "", { className: "field" });
    field.classList.toggle("changed", changed);
    field.append(element("span", name, { title: name }), ...input);
    if (words) {
      field.append(element("small", words));
    }
    if (changed) {
      const button = element("button", "back to the default",
        { className: "back", type: "button" });
      button.addEventListener("click", back);
      field.append(button);
    }
    return field;
  }

  select(values, value, changed) {
    const select = element("select", "");
    for (const [given, text] of values) {
      select.append(element("option", text, { value: given }));
    }
    select.value = value;
    select.addEventListener("change", () => changed(select.value));
    return select;
  }

  text(value, changed) {
    const input = element("input", "", {
      value, autocomplete: "off", spellcheck: false,
    });
    input.addEventListener("change", () => changed(input.value));
    return input;
  }

  listParameters() {
    const box = $("parameters");
    // The fields are not replaced while the user edits them, as the edits would
    // be lost.
    const held = box.contains(document.activeElement)
      ? document.activeElement.dataset.of : null;
    const { parameters } = this.told.model;
    const fields = [];
    let part = null;
    for (const parameter of parameters) {
      // The parts of a plate have parameters of their own.
      if (parameter.part && parameter.part !== part) {
        part = parameter.part;
        fields.push(element("h3", part));
      }
      fields.push(this.parameter(parameter));
    }
    const names = list => [...list].map(f => f.dataset.name).join();
    if (held && names(box.children) === names(fields)) {
      fields.forEach((field, i) => {
        if (field.dataset.name !== held) {
          box.children[i].replaceWith(field);
        }
      });
    } else {
      box.replaceChildren(...fields);
    }
  }

  parameter(parameter) {
    const { name, value, description, min, max, step, choices } = parameter;
    const { key, part } = parameter;
    const to = text => this.change("define", key, String(text));
    const words = [];
    let input;
    if (choices) {
      input = [this.select(choices.map(c => [c, c]), value, to)];
    } else if (typeof value === "boolean") {
      const box = element("input", "", { type: "checkbox", checked: value });
      box.addEventListener("change", () => to(box.checked));
      input = [box];
    } else {
      let slider = null;
      const text = this.text(value, given => {
        if (slider) {
          slider.value = given;
        }
        to(given);
      });
      input = [text];
      if (min !== undefined && max !== undefined) {
        const whole = parameter.type === "integer";
        slider = element("input", "", {
          type: "range", min, max,
          step: step ?? (whole ? 1 : (max - min) / 200), value,
        });
        slider.setAttribute("aria-label", name);
        slider.addEventListener("input", () => {
          text.value = slider.value;
          to(slider.value);
        });
        input.push(slider);
      } else if (min !== undefined) {
        words.push(`at least ${min}`);
      } else if (max !== undefined) {
        words.push(`at most ${max}`);
      }
    }
    words.unshift(...description ? [description] : []);
    // What a plate file says cannot be taken back here.
    const changed = value !== parameter.default
      && (!part || key in this.told.choice.define);
    const field = this.field(name, input, words.join("; "), changed,
      () => this.change("define", key, null));
    field.dataset.name = key;
    for (const control of input) {
      control.dataset.of = key;
    }
    return field;
  }

  listProfiles() {
    const { profiles, choice } = this.told;
    const text = JSON.stringify([profiles, choice.profiles]);
    if (text === this.listed) {
      return;
    }
    this.listed = text;
    $("profiles").replaceChildren(...profiles.map(({ kind, names }) => {
      const chosen = choice.profiles[kind] ?? "";
      const known = chosen && !names.includes(chosen)
        ? [chosen, ...names] : names;
      const values = [["", "default"], ...known.map(name => [name, name])];
      const select = this.select(values, chosen,
        name => this.change("profile", kind, name || null));
      return this.field(kind, [select], "", false);
    }));
  }

  sayWarnings() {
    const { model, print, warnings } = this.told;
    const all = [
      ...warnings, ...model?.warnings ?? [],
      ...print?.of_model === model?.revision ? print?.warnings ?? [] : [],
    ];
    const text = all.join("\n");
    if (text !== this.warned) {
      this.warned = text;
      listWarnings(all);
    }
  }

  async listSettings() {
    const answer = await fetch("settings");
    if (!answer.ok) {
      return;
    }
    const held = $("settings").contains(document.activeElement)
      ? document.activeElement.dataset.of : null;
    const rows = [];
    let section = "";
    for (const setting of await answer.json()) {
      if (setting.section !== section) {
        section = setting.section;
        rows.push(element("h3", section));
      }
      rows.push(this.setting(setting));
    }
    $("settings").replaceChildren(...rows);
    this.filterSettings();
    if (held) {
      [...$("settings").querySelectorAll("input, select")]
        .find(input => input.dataset.of === held)?.focus();
    }
  }

  setting(setting) {
    const { name, value, unit, words, allowed, description, from } = setting;
    const { some_words: some } = setting;
    const to = text => this.change("set", name, text);
    const input = words.length > 0
      ? this.select(words.map(word => [word, word]), value, to)
      : this.text(value, to);
    input.dataset.of = name;
    const rest = [];
    if (words.length === 0 && some.length > 1) {
      // Words that the field offers, beside what may be written.
      const list = element("datalist", "", { id: `words-${name}` });
      list.append(...some.map(word => element("option", "", { value: word })));
      input.setAttribute("list", list.id);
      rest.push(list);
    }
    const origin = from === "default" ? "this is the default"
      : setting.set ? "set on this page" : `from ${from}`;
    const field = this.field(
      unit ? `${name}, ${unit}` : name, [input, ...rest],
      `${description} (${allowed}; ${origin})`, setting.set,
      () => this.change("set", name, null));
    field.dataset.name = name;
    field.dataset.search = `${name} ${description}`.toLowerCase();
    field.dataset.differs = setting.differs;
    return field;
  }

  filterSettings() {
    const words = $("search").value.toLowerCase().split(/\s+/).filter(Boolean);
    const changed = $("only-changed").checked;
    let heading = null;
    for (const row of $("settings").children) {
      if (row.tagName === "H3") {
        heading = row;
        heading.hidden = true;
        continue;
      }
      const { search, differs } = row.dataset;
      row.hidden = !words.every(word => search.includes(word))
        || changed && differs !== "true";
      if (!row.hidden && heading) {
        heading.hidden = false;
      }
    }
  }

  // --- printers

  listPrinters() {
    const { printers, sending } = this.told;
    $("sending").hidden = printers.length === 0;
    const select = $("send-to");
    if ([...select.options].map(o => o.value).join() !== printers.join()) {
      select.replaceChildren(
        ...printers.map(name => element("option", name, { value: name })));
    }
    $("sent").textContent = sending.text;
  }

  async send(start) {
    const { print } = this.told;
    const to = $("send-to").value;
    if (start && !confirm(`Print ${print.file} on ${to} now?`)) {
      return;
    }
    try {
      await this.post("send",
        JSON.stringify({ to, start, print: print.revision }));
    } catch (error) {
      $("sent").textContent = error.message;
    }
  }
}
