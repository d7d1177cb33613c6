// The table of roles: what each amounts to, and which are shown.

// What the table can tell of a role: its amount, and that in words.
const AMOUNTS = {
  time: { of: share => share.time, say: duration },
  length: { of: share => share.length, say: distance },
  filament: {
    of: share => share.volume,
    say: volume => figures.mass === null
      ? `${(volume / 1000).toFixed(2)} cm³`
      : `${(volume * perVolume(figures.mass)).toFixed(2)} g`,
  },
  cost: {
    of: share => share.volume,
    say: volume => (volume * perVolume(figures.cost)).toFixed(2),
  },
};

// The part of `whole` that a cubic millimetre of the beads has.
function perVolume(whole) {
  const all = figures.roles.reduce((sum, share) => sum + share.volume, 0);
  return all > 0 ? whole / all : 0;
}

function listRoles() {
  const body = $("roles").tBodies[0];
  body.replaceChildren();
  const costs = figures.cost !== null;
  for (const button of $("amounts").children) {
    const { amount } = button.dataset;
    button.hidden = amount === "cost" && !costs;
    if (amount === state.amount && button.hidden) {
      state.amount = "time";
    }
  }
  for (const button of $("amounts").children) {
    button.setAttribute(
      "aria-pressed", button.dataset.amount === state.amount);
  }
  const { of, say } = AMOUNTS[state.amount];
  const all = [...figures.roles, figures.travel]
    .reduce((sum, share) => sum + of(share), 0);
  const add = (role, name, share) => {
    const row = body.insertRow();
    row.dataset.role = role;
    const button = element("button", "", { className: "role" });
    button.append(
      element("span", "", { className: "swatch" }), element("span", name));
    button.title = role === TRAVEL
      ? "Show or hide travels (T)" : "Show or hide; with Shift, only this";
    button.addEventListener(
      "click", event => toggleRole(role, event.shiftKey));
    row.insertCell().append(button);
    const amount = of(share);
    row.insertCell().textContent = amount > 0 ? say(amount) : "–";
    row.insertCell().textContent = amount > 0 ? percent(amount / all) : "";
    const off = Boolean(state.hidden >> role & 1);
    button.setAttribute("aria-pressed", !off);
    row.classList.toggle("off", off);
    row.classList.toggle("travel", role === TRAVEL);
  };
  figures.roles.forEach((share, role) => {
    if (share.moves > 0) {
      add(role, told.role_names[role], share);
    }
  });
  if (figures.travel.moves > 0) {
    add(TRAVEL, "travel", figures.travel);
  }
}

function setAmount(amount) {
  state.amount = amount;
  if (told) {
    listRoles();
    setMode(state.mode);
  }
}

function toggleRole(role, alone) {
  const all = [...$("roles").tBodies[0].rows]
    .map(row => Number(row.dataset.role)).filter(r => r !== TRAVEL);
  if (alone && role !== TRAVEL) {
    const others = all.filter(r => r !== role);
    const isAlone = others.every(r => state.hidden >> r & 1)
      && !(state.hidden >> role & 1);
    for (const other of others) {
      state.hidden = isAlone
        ? state.hidden & ~(1 << other) : state.hidden | 1 << other;
    }
    state.hidden &= ~(1 << role);
  } else {
    state.hidden ^= 1 << role;
  }
  for (const row of $("roles").tBodies[0].rows) {
    const off = state.hidden >> Number(row.dataset.role) & 1;
    row.classList.toggle("off", Boolean(off));
    row.querySelector("button").setAttribute("aria-pressed", !off);
  }
  redraw(false);
}

