// The preview's page in headless Chromium: started by run.sh.
//
//     node preview.mjs FOLDER [SCREENSHOTS]
//
// FOLDER has own.html, cura.html, orca.html and evil.html. Pictures are taken
// of the window and compared as pixels.

import { chromium } from "playwright-core";
import assert from "node:assert/strict";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";
import { pathToFileURL } from "node:url";

const [folder, screenshots] = process.argv.slice(2);

const profile = fs.mkdtempSync(path.join(os.tmpdir(), "isoslice-browser-"));
const context = await chromium.launchPersistentContext(profile, {
  executablePath: process.env.CHROMIUM,
  headless: false, // said below, in the browser's own words
  viewport: { width: 860, height: 560 },
  hasTouch: true,
  args: [
    "--headless", "--no-sandbox", "--disable-gpu", "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update",
    "--disable-sync",
  ],
});

const failures = [];
let tests = 0;

async function test(name, body) {
  tests++;
  try {
    await body();
    console.log(`ok    ${name}`);
  } catch (error) {
    failures.push(name);
    console.log(`FAIL  ${name}\n${error.stack}`);
  }
}

// Opens a page; whatever goes wrong in it is a failure of the test.
async function open(name, { scheme = "light", before } = {}) {
  const page = await context.newPage();
  page.faults = [];
  page.on("console", message => {
    if (message.type() === "error") {
      page.faults.push(message.text());
    }
  });
  page.on("pageerror", error => page.faults.push(error.message));
  page.on("dialog", dialog => {
    page.faults.push(`a dialog: ${dialog.message()}`);
    dialog.dismiss();
  });
  page.on("request", request => {
    if (!/^(file|data|blob):/.test(request.url())) {
      page.faults.push(`a request: ${request.url()}`);
    }
  });
  await page.emulateMedia({ colorScheme: scheme });
  if (before) {
    await page.addInitScript(before);
  }
  await page.goto(pathToFileURL(path.join(folder, name)).href);
  await page.waitForSelector("html[data-ready]", { timeout: 60_000 });
  await still(page);
  return page;
}

async function close(page) {
  assert.deepEqual(page.faults, []);
  await page.close();
}

// Waits until the picture at rest has been drawn.
async function still(page) {
  await page.waitForTimeout(350);
  await page.evaluate(() => new Promise(done =>
    requestAnimationFrame(() => requestAnimationFrame(done))));
}

// Pictures are looked at in a page of their own, where pixels are at hand.
const bench = await context.newPage();
await bench.evaluate(() => {
  window.pictures = [];
  window.keep = async url => {
    const image = new Image();
    image.src = url;
    await image.decode();
    const canvas = document.createElement("canvas");
    canvas.width = image.width;
    canvas.height = image.height;
    const to = canvas.getContext("2d");
    to.drawImage(image, 0, 0);
    return window.pictures.push(
      to.getImageData(0, 0, image.width, image.height).data) - 1;
  };
  window.different = (a, b) => {
    const [p, q] = [window.pictures[a], window.pictures[b]];
    let found = 0;
    for (let i = 0; i < p.length; i += 4) {
      found += [0, 1, 2].some(k => Math.abs(p[i + k] - q[i + k]) > 8);
    }
    return found;
  };
  window.count = (a, want) => {
    const p = window.pictures[a];
    const size = Math.hypot(...want);
    let found = 0;
    for (let i = 0; i < p.length; i += 4) {
      const length = Math.hypot(p[i], p[i + 1], p[i + 2]);
      const along =
        p[i] * want[0] + p[i + 1] * want[1] + p[i + 2] * want[2];
      found += length > 60 && along > 0.9975 * length * size;
    }
    return found;
  };
});

// Width and height of what is not the ground, pixels. The labels of the layers
// are on the right.
const extent = a => bench.evaluate(a => {
  const [p, width, right] = [window.pictures[a], 500, 420];
  const [xs, ys] = [[], []];
  for (let i = 0; i < p.length; i += 4) {
    const [x, y] = [i / 4 % width, Math.floor(i / 4 / width)];
    if (x < right && [0, 1, 2].some(k => Math.abs(p[i + k] - p[k]) > 8)) {
      xs.push(x);
      ys.push(y);
    }
  }
  const span = list =>
    list.reduce((m, n) => Math.max(m, n)) - list.reduce((m, n) => Math.min(m, n));
  return [span(xs), span(ys)];
}, a);

// A picture of the part of the window where the print is; its number.
async function picture(page) {
  const clip = { x: 300, y: 80, width: 500, height: 390 };
  const png = (await page.screenshot({ clip })).toString("base64");
  return bench.evaluate(
    url => window.keep(url), `data:image/png;base64,${png}`);
}

// How many pixels differ.
const different = (a, b) =>
  bench.evaluate(([a, b]) => window.different(a, b), [a, b]);

const parse = hex => [1, 3, 5].map(i => parseInt(hex.slice(i, i + 2), 16));

// How many pixels have this colour, in whatever light.
const count = (a, hex) =>
  bench.evaluate(([a, want]) => window.count(a, want), [a, parse(hex)]);

// The ground's colour.
const ground = page => picture(page).then(a =>
  bench.evaluate(a => [...window.pictures[a].slice(0, 3)], a));

const ORANGE = "#e0703a"; // outer walls
const VIOLET = "#8a68bf"; // skin
const SUPPORT = "#7ea35b";
const INTERFACE = "#4d7a43"; // dense layers of supports

async function press(page, ...keys) {
  for (const key of keys) {
    await page.keyboard.press(key);
  }
  await still(page);
}

const role = (page, name) =>
  page.locator("#roles .role", { hasText: new RegExp(`^${name}$`) });

async function shot(page, name) {
  if (screenshots) {
    await page.screenshot({ path: path.join(screenshots, `${name}.png`) });
  }
}

for (const [name, made, layers] of [
  ["own", "isoslice", 32], ["cura", "Cura SteamEngine 5.9.0", 4],
  ["orca", "OrcaSlicer 2.3.0", 3],
]) {
  await test(`${name}: it opens, says what it is, and shows its walls`,
    async () => {
      const page = await open(`${name}.html`);
      const summary = await page.locator("#summary").textContent();
      assert.ok(summary.includes(made), summary);
      assert.ok(summary.includes(`${layers} layers`), summary);
      const walls = await count(await picture(page), ORANGE);
      assert.ok(walls > 1500, `${walls} pixels of outer wall`);
      await shot(page, name);
      await close(page);
    });
}

await test("the layer slider changes pixels", async () => {
  const page = await open("own.html");
  const whole = await picture(page);
  const box = await page.locator("#layer-slider").boundingBox();
  const x = box.x + box.width / 2;
  await page.mouse.move(x, box.y);
  await page.mouse.down();
  await page.mouse.move(x, box.y + box.height / 2, { steps: 4 });
  await page.mouse.up();
  await still(page);
  const layer = await page.locator("#layer-high b").textContent();
  assert.ok(Math.abs(Number(layer) - 16) <= 2, `layer ${layer}`);
  assert.ok(await different(whole, await picture(page)) > 2500);
  await press(page, "End");
  assert.ok(await different(whole, await picture(page)) < 300);
  // One layer only, and back.
  await press(page, "ArrowDown", "o");
  const low = await page.locator("#layer-low b").textContent();
  assert.equal(low, "31");
  assert.ok(await different(whole, await picture(page)) > 2500);
  await press(page, "o", "End");
  assert.ok(await different(whole, await picture(page)) < 300);
  await close(page);
});

await test("the move slider goes back and says where it is", async () => {
  const page = await open("cura.html");
  const whole = await picture(page);
  await press(page, "ArrowLeft", "ArrowLeft", "ArrowLeft");
  const text = await page.locator("#move-text").textContent();
  assert.match(text, /^Move \d+ of \d+ · .*mm\/s.* · line \d+$/);
  assert.ok(await different(whole, await picture(page)) > 1000);
  await shot(page, "move");
  await close(page);
});

await test("a role's toggle hides its colour", async () => {
  const page = await open("own.html");
  const before = await count(await picture(page), ORANGE);
  await role(page, "outer wall").click();
  await still(page);
  const after = await count(await picture(page), ORANGE);
  assert.ok(before > 2500 && after < before / 50, `${before}, ${after}`);
  await role(page, "outer wall").click();
  await still(page);
  const again = await count(await picture(page), ORANGE);
  assert.ok(Math.abs(again - before) < before / 50, `${before}, ${again}`);
  // With Shift, only this one.
  await role(page, "outer wall").click({ modifiers: ["Shift"] });
  await still(page);
  const alone = await picture(page);
  assert.ok(await count(alone, ORANGE) > 2500);
  assert.ok(await count(alone, VIOLET) < 50);
  await close(page);
});

await test("supports and their dense layers are seen, counted and hidden",
  async () => {
    const page = await open("held.html");
    // From below both are seen.
    for (const [name, colour] of [
      ["support", SUPPORT], ["support interface", INTERFACE],
    ]) {
      const named = page.locator(
        ".role", { hasText: new RegExp(`^${name}$`) });
      const row = page.locator("#roles tr", { has: named });
      for (const amount of ["time", "length", "filament"]) {
        await page.locator(`#amounts [data-amount=${amount}]`).click();
        const [, said, share] = await row.locator("td").allTextContents();
        assert.match(said, /[1-9]/, `${name}: ${amount}: ${said}`);
        assert.match(share, /%$/, `${name}: ${amount}: ${share}`);
      }
      await role(page, name).click({ modifiers: ["Shift"] });
      await still(page);
      const alone = await count(await picture(page), colour);
      assert.ok(alone > 300, `${name}: ${alone} pixels`);
      assert.ok(await count(await picture(page), ORANGE) < 50, name);
      await role(page, name).click({ modifiers: ["Shift"] });
      await role(page, name).click();
      await still(page);
      const without = await count(await picture(page), colour);
      assert.ok(without < alone / 20, `${name}: ${without} of ${alone}`);
      await role(page, name).click();
      await still(page);
    }
    await shot(page, "held");
    await close(page);
  });

await test("travels can be shown", async () => {
  const page = await open("orca.html");
  const without = await picture(page);
  await press(page, "t");
  const travels = await picture(page);
  assert.ok(await different(without, travels) > 300);
  await role(page, "travel").click();
  await still(page);
  assert.ok(await different(without, await picture(page)) < 100);
  await close(page);
});

await test("each colouring is another, with its scale", async () => {
  const page = await open("orca.html");
  const seen = [await picture(page)];
  for (const mode of ["speed", "width", "height", "flow", "time"]) {
    await page.locator(`#modes [data-mode=${mode}]`).click();
    await still(page);
    const now = await picture(page);
    if (mode !== "height") {
      for (const before of seen) {
        assert.ok(await different(before, now) > 2000, mode);
      }
    }
    seen.push(now);
    assert.ok(await page.locator("#scale").isVisible());
    await shot(page, mode);
  }
  // All layers are 0.24 mm high.
  await press(page, "4");
  assert.equal(await page.locator("#scale-low").textContent(), "0.24");
  await press(page, "2");
  assert.equal(await page.locator("#scale-high").textContent(), "200");
  await press(page, "1");
  assert.ok(await different(seen[0], await picture(page)) < 300);
  await close(page);
});

await test("fans and the nozzle's heat are colours, too", async () => {
  const page = await open("own.html");
  await press(page, "6");
  // The first layer is 5 °C hotter than the others.
  assert.equal(await page.locator("#scale-low").textContent(), "210");
  assert.equal(await page.locator("#scale-high").textContent(), "215");
  const heat = await picture(page);
  await press(page, "7");
  assert.equal(await page.locator("#scale-low").textContent(), "0");
  assert.equal(await page.locator("#scale-high").textContent(), "100");
  assert.ok(await different(heat, await picture(page)) > 2500);
  await shot(page, "fan");
  await press(page, "8");
  const middle = await page.locator("#scale-middle").textContent();
  assert.match(middle, /s a layer$/);
  await close(page);
});

await test("each role's share of time, filament and cost", async () => {
  const page = await open("own.html");
  const row = role(page, "outer wall").locator("xpath=ancestor::tr");
  assert.match(await row.textContent(), /\d+s\d+ %$/);
  await page.locator("[data-amount=filament]").click();
  assert.match(await row.textContent(), /\d+\.\d\d g\d+ %$/);
  const shares = await page.locator("#roles td:last-child").allTextContents();
  const sum = shares.reduce((sum, text) => sum + (parseFloat(text) || 0), 0);
  assert.ok(Math.abs(sum - 100) <= 3, `${sum} %`);
  await page.locator("[data-amount=cost]").click();
  assert.match(await row.textContent(), /wall0\.\d\d\d+ %$/);
  const figures = await page.locator("#figures").textContent();
  assert.match(figures, /Cost\d+\.\d\d/);
  await shot(page, "cost");
  await close(page);
  // Orca's file tells no price.
  const other = await open("orca.html");
  assert.ok(await other.locator("[data-amount=cost]").isHidden());
  await close(other);
});

await test("seams and retractions are marked", async () => {
  const page = await open("own.html");
  // The seams are behind.
  await page.mouse.move(770, 400);
  await page.mouse.down();
  await page.mouse.move(340, 400, { steps: 3 });
  await page.mouse.up();
  await still(page);
  const before = await picture(page);
  await press(page, "s");
  const seams = await picture(page);
  assert.ok(await different(before, seams) > 60, "seams");
  const found = page.locator("[data-mark=seams] td").nth(1);
  // One outer wall in each layer.
  assert.equal(await found.textContent(), "32");
  await shot(page, "seams");
  await press(page, "s");
  assert.ok(await different(before, await picture(page)) < 30, "off again");
  await page.locator("[data-mark=retractions] button").click();
  await still(page);
  const count = page.locator("[data-mark=retractions] td").nth(1);
  assert.match(await count.textContent(), /^[1-9]\d*$/);
  assert.ok(await different(before, await picture(page)) > 20, "retractions");
  await close(page);
});

await test("a bead is picked, and tells its figures and its line", async () => {
  const page = await open("own.html");
  await press(page, "v");
  const before = await picture(page);
  // The middle of the top, seen from above.
  await page.mouse.click(560, 280);
  await still(page);
  const text = await page.locator("#picked").textContent();
  assert.match(text, /top skin/);
  assert.match(text, /Layer32, 7\.95 mm/);
  assert.match(text, /Bead0\.\d\d × 0\.25 mm/);
  assert.match(text, /Line\d+/);
  assert.match(text, /Nozzle210 °C/);
  assert.ok(await different(before, await picture(page)) > 100, "no mark");
  await shot(page, "picked");
  // The line is that of the G-code.
  const line = Number(text.match(/Line(\d+)/)[1]);
  const gcode = fs.readFileSync(path.join(folder, "own.gcode"), "utf8");
  const said = gcode.split("\n")[line - 1];
  const [x, y] = text.match(/To(-?[\d.]+), (-?[\d.]+)/).slice(1).map(Number);
  const of = letter => Number(said.match(new RegExp(`${letter}(-?[\\d.]+)`))[1]);
  assert.ok(Math.abs(of("X") - x) < 0.011, `${said}, ${x}`);
  assert.ok(Math.abs(of("Y") - y) < 0.011, `${said}, ${y}`);
  await page.locator("#go-to-picked").click();
  const move = await page.locator("#move-text").textContent();
  assert.ok(move.includes(`line ${line}`), move);
  await press(page, "Escape");
  assert.ok(await page.locator("#picked").isHidden());
  // Without a pointer: the last move that is shown.
  await page.locator("#view").focus();
  await press(page, "ArrowLeft", "Enter");
  assert.ok(await page.locator("#picked").isVisible());
  // Beside the print there is nothing.
  await page.mouse.click(330, 460);
  await still(page);
  assert.ok(await page.locator("#picked").isHidden());
  await close(page);
});

await test("a plane cuts the print open", async () => {
  const page = await open("own.html");
  const whole = await picture(page);
  const walls = await count(whole, ORANGE);
  await page.locator("[data-cut=y]").click();
  await still(page);
  const open_ = await picture(page);
  assert.ok(await count(open_, ORANGE) < 0.7 * walls, "the front is left");
  await shot(page, "cut");
  await page.locator("#cut-at").focus();
  await press(page, "End");
  assert.ok(await different(whole, await picture(page)) < 300, "at its end");
  await press(page, "Home");
  assert.ok(await count(await picture(page), ORANGE) < walls / 20, "at its other end");
  await page.locator("#cut-flip").click();
  await still(page);
  assert.ok(await different(whole, await picture(page)) < 300, "flipped");
  await page.locator("#view").focus();
  await press(page, "x", "x");
  assert.ok(await page.locator("#cut-place").isHidden());
  assert.ok(await different(whole, await picture(page)) < 300, "off");
  await close(page);
});

await test("the bed is the printer's", async () => {
  const page = await open("warned.html");
  await press(page, "v");
  await page.mouse.move(560, 280);
  for (let i = 0; i < 7; i++) {
    await page.mouse.wheel(0, 200);
  }
  await still(page);
  await shot(page, "bed");
  // 100 × 50 mm, from above.
  const [width, height] = await extent(await picture(page));
  assert.ok(width > 150 && width < 420, `${width} pixels`);
  assert.ok(Math.abs(width / height - 2) < 0.05, `${width} × ${height}`);
  await close(page);
});

await test("warnings are listed and shown where they are", async () => {
  const page = await open("warned.html");
  const warnings = page.locator("#warnings button");
  const text = await warnings.first().textContent();
  assert.match(text, /begins at x = 70\.0.*z = 6\.\d on the bed/);
  const before = await picture(page);
  await warnings.first().click();
  await still(page);
  const z = Number(text.match(/z = ([\d.]+)/)[1]);
  const layer = await page.locator("#layer-high").textContent();
  assert.ok(Math.abs(Number(layer.match(/([\d.]+) mm/)[1]) - z) < 0.31, layer);
  assert.ok(await different(before, await picture(page)) > 1000);
  await shot(page, "warning");
  await close(page);
});

await test("every control can be reached by keyboard", async () => {
  const page = await open("own.html");
  await page.locator("[data-cut=x]").click();
  const wanted = await page.evaluate(() =>
    [...document.querySelectorAll("button, input, a, [tabindex]")]
      .filter(e => e.checkVisibility() && !e.disabled).length);
  await page.locator("#view").focus();
  const seen = new Set();
  for (let i = 0; i < wanted + 10; i++) {
    seen.add(await page.evaluate(() => {
      const e = document.activeElement;
      e.dataset.seen ??= String(Math.random());
      return e === document.body ? "" : e.dataset.seen;
    }));
    await page.keyboard.press("Tab");
  }
  seen.delete("");
  assert.equal(seen.size, wanted);
  await close(page);
});

await test("light and dark", async () => {
  const light = await open("own.html");
  assert.ok((await ground(light)).every(c => c > 200));
  await close(light);
  const page = await open("own.html", { scheme: "dark" });
  assert.ok((await ground(page)).every(c => c < 60));
  await shot(page, "dark");
  await page.locator("#theme").click();
  await still(page);
  assert.ok((await ground(page)).every(c => c > 200));
  // It is remembered.
  await page.reload();
  await page.waitForSelector("html[data-ready]");
  await still(page);
  assert.ok((await ground(page)).every(c => c > 200));
  await page.locator("#theme").click();
  await close(page);
});

await test("mouse and wheel lead the camera", async () => {
  const page = await open("own.html");
  const before = await picture(page);
  await page.mouse.move(560, 280);
  await page.mouse.down();
  await page.mouse.move(660, 230, { steps: 3 });
  await page.mouse.up();
  await still(page);
  const turned = await picture(page);
  assert.ok(await different(before, turned) > 3000, "turned");
  await page.mouse.wheel(0, -400);
  await still(page);
  const zoomed = await picture(page);
  assert.ok(await count(zoomed, ORANGE) > 1.3 * await count(turned, ORANGE), "zoomed");
  await page.mouse.dblclick(560, 280);
  await still(page);
  assert.ok(await different(before, await picture(page)) < 500, "fitted");
  await press(page, "v");
  await shot(page, "above");
  await close(page);
});

await test("two fingers zoom", async () => {
  const page = await open("own.html");
  const before = await count(await picture(page), ORANGE);
  const session = await context.newCDPSession(page);
  const touch = (type, spread) => session.send("Input.dispatchTouchEvent", {
    type,
    touchPoints: type === "touchEnd" ? [] : [
      { id: 0, x: 570 - spread, y: 280 }, { id: 1, x: 570 + spread, y: 280 },
    ],
  });
  await touch("touchStart", 50);
  for (let spread = 55; spread <= 100; spread += 5) {
    await touch("touchMove", spread);
  }
  await touch("touchEnd");
  await still(page);
  const after = await count(await picture(page), ORANGE);
  assert.ok(after > 1.5 * before, `${before}, ${after}`);
  await close(page);
});

await test("help, and a phone's window", async () => {
  const page = await open("orca.html");
  await press(page, "?");
  assert.ok(await page.locator("#help").isVisible());
  await shot(page, "help");
  await press(page, "Escape");
  assert.ok(!await page.locator("#help").isVisible());
  await page.setViewportSize({ width: 390, height: 760 });
  await page.reload();
  await page.waitForSelector("html[data-ready]");
  await still(page);
  assert.ok(!await page.locator("#panel").isVisible());
  await page.locator("#show-panel").click();
  assert.ok(await page.locator("#panel").isVisible());
  await shot(page, "phone");
  const wide = await page.evaluate(
    () => document.documentElement.scrollWidth > innerWidth);
  assert.ok(!wide, "nothing lies beside the window");
  await close(page);
});

await test("a browser without DecompressionStream", async () => {
  const page = await open("own.html", {
    before: () => { delete window.DecompressionStream; },
  });
  assert.ok(await count(await picture(page), ORANGE) > 2500);
  await close(page);
});

await test("nothing in a file becomes a script", async () => {
  const page = await open("evil.html");
  const name = await page.locator("h1").textContent();
  assert.ok(name.includes("onerror=alert(1)"), name);
  const summary = await page.locator("#summary").textContent();
  assert.ok(summary.includes("<script>alert(2)"), summary);
  assert.equal(await page.locator("img").count(), 0);
  await close(page);
});

if (screenshots) {
  const page = await open("ball.html", {
    before: () => localStorage.removeItem("isoslice-theme"),
  });
  await page.setViewportSize({ width: 960, height: 640 });
  for (let i = 0; i < 4; i++) {
    await press(page, "Shift+ArrowDown");
  }
  for (let i = 0; i < 12; i++) {
    await press(page, "Shift+ArrowLeft");
  }
  await shot(page, "ball");
  await close(page);
}

await context.close();
fs.rmSync(profile, { recursive: true, force: true });
console.log(`${tests - failures.length} of ${tests} browser tests passed`);
process.exit(failures.length > 0 ? 1 : 0);
