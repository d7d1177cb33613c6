// Numbers in words, and small helpers for the page's elements.

const $ = id => document.getElementById(id);

function rgb(hex) {
  return [1, 3, 5].map(i => parseInt(hex.trim().slice(i, i + 2), 16) / 255);
}

function duration(seconds) {
  const s = Math.round(seconds);
  const [h, m] = [Math.floor(s / 3600), Math.floor(s / 60) % 60];
  return h > 0 ? `${h}h ${m}m` : m > 0 ? `${m}m ${s % 60}s` : `${s}s`;
}

function distance(mm) {
  return mm < 1000 ? `${mm.toFixed(0)} mm` : `${(mm / 1000).toFixed(2)} m`;
}

function percent(share) {
  return share > 0 && share < 0.01 ? "< 1 %" : `${(100 * share).toFixed(0)} %`;
}

function element(tag, text, properties = {}) {
  const made = document.createElement(tag);
  made.textContent = text;
  return Object.assign(made, properties);
}
