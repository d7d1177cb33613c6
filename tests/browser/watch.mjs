// The page of `isoslice watch` in headless Chromium: started by run.sh.
//
//     node watch.mjs ISOSLICE FOLDER [SCREENSHOTS]
//
// It writes a model into FOLDER, edits it, and looks at what the page does.

import { chromium } from "playwright-core";
import { spawn } from "node:child_process";
import assert from "node:assert/strict";
import fs from "node:fs";
import http from "node:http";
import path from "node:path";

const [isoslice, folder, screenshots] = process.argv.slice(2);
const model = path.join(folder, "watched.rhai");
const write = text => fs.writeFileSync(model, text);
const good = height => `
let r = param("radius", 8.0, "of the foot, mm", #{ min: 4, max: 12 });
let sides = param("sides", 4, "how many", #{ choices: [4, 6] });
let hollow = param("hollow", false);
// <img src=x onerror=alert(1)>
let f = max(sqrt(x * x + y * y) - r, abs(z - ${height / 2}) - ${height / 2});
if hollow { max(f, r / 2.0 - sqrt(x * x + y * y)) } else { f }
`;
write(good(4));

// Starts the program; its process, and the page's address.
async function watch(file) {
  const server = spawn(isoslice, [
    "watch", file, "--set", "skirt.loops=0", "--set", "first_layer_height=0.15",
  ]);
  let said = "";
  server.stdout.on("data", text => { said += text; });
  server.stderr.pipe(process.stderr);
  const address = await new Promise((resolve, reject) => {
    server.on("exit", code => reject(new Error(`watch ended with ${code}`)));
    server.stdout.on("data", () => {
      const found = said.match(/http:\/\/127\.0\.0\.1:\d+\/[0-9a-f]{32}\//);
      if (found) {
        resolve(found[0]);
      }
    });
  });
  return [server, address];
}
const [server, address] = await watch(model);

const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM,
  args: [
    "--no-sandbox", "--disable-gpu", "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader", "--no-first-run",
    "--disable-background-networking",
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

async function open(size = { width: 1400, height: 900 }, at = address) {
  const page = await browser.newPage({ viewport: size });
  page.faults = [];
  page.on("pageerror", error => page.faults.push(error.message));
  page.on("dialog", dialog => {
    page.faults.push(`a dialog: ${dialog.message()}`);
    dialog.dismiss();
  });
  page.on("request", request => {
    const url = request.url();
    if (!url.startsWith(at) && !/^(data|blob):/.test(url)) {
      page.faults.push(`a request: ${url}`);
    }
  });
  await page.goto(at);
  await state(page, "done");
  return page;
}

const state = (page, name) =>
  page.waitForSelector(`html[data-state="${name}"]`, { timeout: 60_000 });
const layers = async (page, count) =>
  page.waitForFunction(
    count => document.getElementById("move-text").textContent
      .includes(`of ${count} `),
    count, { timeout: 60_000 });
const shoot = (page, name) => screenshots
  && page.screenshot({ path: path.join(screenshots, `${name}.png`) });

const page = await open();

await test("the sliced part is shown", async () => {
  await layers(page, 20);
  assert.equal(await page.title(), "watched.rhai");
  assert.equal(await page.getAttribute("html", "data-shows"), "layers");
  await shoot(page, "watch");
});

await test("an edit shows at once and keeps camera and layer", async () => {
  await page.locator("#view").focus();
  await page.keyboard.press("v");
  for (let i = 0; i < 10; i++) {
    await page.keyboard.press("ArrowDown");
  }
  const before = await page.textContent("#layer-high");
  write(good(6));
  await layers(page, 30);
  await state(page, "done");
  assert.equal(await page.textContent("#layer-high"), before);
  const shown = await page.waitForSelector("#picture", { state: "attached" });
  assert.ok(await shown.evaluate(image => image.naturalWidth > 0),
    "no picture of the part was drawn");
});

await test("a mistake is shown with its line, and goes away", async () => {
  write("let r = 8.0;\nsqrt(x * x + y * y) - rr\n");
  await state(page, "wrong");
  const fault = await page.textContent("#fault");
  assert.match(fault, /line 2/);
  assert.match(fault, /2 \| sqrt\(x \* x \+ y \* y\) - rr/);
  assert.equal(await page.getAttribute("#save-gcode", "aria-disabled"), "true");
  await shoot(page, "watch-wrong");
  write(good(4));
  await state(page, "done");
  await layers(page, 20);
  assert.ok(await page.locator("#fault").isHidden());
});

await test("a slider changes the part", async () => {
  const slider = page.locator('[data-name="radius"] input[type="range"]');
  await slider.evaluate(input => {
    input.value = 10;
    input.dispatchEvent(new Event("input"));
  });
  await page.waitForFunction(() =>
    document.querySelector("#figures").textContent.includes("20.0 × 20.0"),
  null, { timeout: 60_000 });
  const field = page.locator('[data-name="radius"]');
  assert.ok((await field.getAttribute("class")).includes("changed"));
});

await test("the layer that is shown comes before the others", async () => {
  // As many layers as take a while.
  write(good(120));
  await layers(page, 600);
  await state(page, "done");
  await page.locator("#view").focus();
  await page.keyboard.press("f");
  await page.keyboard.press("End");
  for (let i = 0; i < 100; i++) {
    await page.keyboard.press("ArrowDown");
  }
  const high = await page.textContent("#layer-high");
  assert.match(high, /^500 /);
  const low = await page.textContent("#layer-low");
  // The page tells of the layer when the slider rests.
  await page.waitForTimeout(500);
  const shown = await page.evaluate(() => {
    window.seen = [];
    const root = document.documentElement;
    new MutationObserver(() => window.seen.push(
      [root.dataset.shows, root.dataset.glimpse, root.dataset.state].join()))
      .observe(root, { attributes: true });
    return root.dataset.shows;
  });
  const slider = page.locator('[data-name="radius"] input[type="range"]');
  const slide = to => slider.evaluate((input, to) => {
    input.value = to;
    input.dispatchEvent(new Event("input"));
  }, to);
  assert.equal(shown, "layers");
  await slide(9);
  await page.waitForFunction(() =>
    window.seen.some(seen => seen.endsWith("true,busy")),
  null, { timeout: 60_000 });
  assert.equal(await page.textContent("#layer-high"), high);
  await shoot(page, "watch-glimpse");
  await state(page, "done");
  await page.waitForSelector('html[data-glimpse="false"]');
  assert.equal(await page.textContent("#layer-high"), high);
  assert.equal(await page.textContent("#layer-low"), low);
  // The picture of the part was not shown in between.
  const seen = await page.evaluate(() => window.seen);
  assert.ok(!seen.some(seen => seen.startsWith("part")), seen.join(" "));
  assert.deepEqual(page.faults, []);
  write(good(4));
  await layers(page, 20);
  await state(page, "done");
  await slide(10);
  await page.waitForFunction(() =>
    document.querySelector("#figures").textContent.includes("20.0 × 20.0"),
  null, { timeout: 60_000 });
});

await test("a second tab shows the same, and changes the first", async () => {
  const second = await open({ width: 420, height: 800 });
  await second.waitForFunction(() =>
    document.querySelector("#figures").textContent.includes("20.0 × 20.0"));
  assert.ok(await second.locator("#views").isVisible());
  await shoot(second, "watch-phone");
  if (await second.locator("#panel").isHidden()) {
    await second.click("#show-panel");
  }
  // The part stands above the panel, and nothing of it on the panel.
  const box = async name => second.locator(name).boundingBox();
  await second.click('[data-view="part"]');
  await second.waitForSelector("#picture:not([hidden])");
  const [panel, picture] = [await box("#panel"), await box("#picture")];
  assert.ok(picture.y + picture.height <= panel.y + 1,
    `picture ${JSON.stringify(picture)}, panel ${JSON.stringify(panel)}`);
  await shoot(second, "watch-phone-part");
  await second.click('[data-view="layers"]');
  await shoot(second, "watch-phone-panel");
  await second.locator('[data-name="radius"] .back').click();
  await page.waitForFunction(() =>
    document.querySelector("#figures").textContent.includes("16.0 × 16.0"),
  null, { timeout: 60_000 });
  assert.deepEqual(second.faults, []);
  await second.close();
});

await test("settings can be searched, changed and saved", async () => {
  await page.click('[data-tab="settings"]');
  await page.fill("#search", "layer_height");
  const row = page.locator('[data-name="layer_height"]');
  await row.locator("input").fill("0.38");
  await row.locator("input").press("Enter");
  await layers(page, 11);
  await shoot(page, "watch-settings");
  const [download] = await Promise.all([
    page.waitForEvent("download"),
    (async () => {
      await page.click('[data-tab="model"]');
      await page.click("#save-settings");
    })(),
  ]);
  const saved = fs.readFileSync(await download.path(), "utf8");
  assert.match(saved, /^layer_height = 0.38$/m);
  assert.match(saved, /^skirt.loops = 0$/m);
});

await test("a setting that is wrong is said, and can be mended", async () => {
  await page.click('[data-tab="settings"]');
  await page.fill("#search", "layer_height");
  const input = page.locator('[data-name="layer_height"] input');
  await input.fill("9");
  await input.press("Enter");
  await state(page, "wrong");
  assert.match(await page.textContent("#fault"), /layer_height/);
  await input.fill("0.2");
  await input.press("Enter");
  await state(page, "done");
});

await test("the G-code is saved", async () => {
  await page.click('[data-tab="model"]');
  const [download] = await Promise.all([
    page.waitForEvent("download"), page.click("#save-gcode"),
  ]);
  assert.equal(download.suggestedFilename(), "watched.gcode");
  const saved = fs.readFileSync(await download.path(), "utf8");
  assert.ok(saved.includes(";LAYER_CHANGE"));
});

await test("the part turns", async () => {
  await page.click('[data-view="part"]');
  await page.waitForTimeout(500);
  const source = () => page.getAttribute("#picture", "src");
  const before = await source();
  await page.mouse.move(800, 500);
  await page.mouse.down();
  await page.mouse.move(900, 520, { steps: 5 });
  await page.mouse.up();
  await page.waitForFunction(
    before => document.getElementById("picture").src !== before, before);
  await page.waitForTimeout(800);
  await shoot(page, "watch-part");
  await page.click('[data-view="layers"]');
});

await test("a bead is picked, and its line of the G-code is shown", async () => {
  await page.locator("#view").focus();
  await page.keyboard.press("ArrowLeft");
  await page.keyboard.press("Enter");
  await page.waitForFunction(() =>
    document.querySelector("#picked pre").textContent.startsWith("G1 "));
  await shoot(page, "watch-picked");
  await page.keyboard.press("Escape");
  assert.ok(await page.locator("#picked").isHidden());
});

await test("10,000 requests a minute do not starve a run", async () => {
  const { port, pathname } = new URL(address);
  const agent = new http.Agent({ keepAlive: true, maxSockets: 16 });
  const ask = () => new Promise((resolve, reject) => http.get(
    { host: "127.0.0.1", port, path: `${pathname}settings`, agent },
    answer => { answer.resume(); answer.on("end", () => resolve(answer.statusCode)); },
  ).on("error", reject));
  const answers = [];
  // A busy machine rings late; what is due then is asked at once.
  const began = Date.now();
  const every = setInterval(() => {
    while (answers.length < (Date.now() - began) / 6) {
      answers.push(ask());
    }
  }, 6);
  try {
    await page.waitForTimeout(1000);
    write(good(5));
    await layers(page, 25);
    await page.waitForTimeout(1000);
  } finally {
    clearInterval(every);
  }
  const codes = await Promise.all(answers);
  assert.ok(codes.length > 150, `${codes.length} requests`);
  assert.deepEqual(codes.filter(code => code !== 200), []);
  agent.destroy();
});

await test("other hosts and origins are refused", async () => {
  const { port, pathname } = new URL(address);
  const ask = headers => new Promise((resolve, reject) => http.get(
    { host: "127.0.0.1", port, path: `${pathname}state`, headers },
    answer => { answer.resume(); resolve(answer.statusCode); },
  ).on("error", reject));
  assert.equal(await ask({}), 200);
  assert.equal(await ask({ host: `evil.example:${port}` }), 421);
  assert.equal(await ask({ origin: "http://evil.example" }), 403);
  assert.equal(await ask({ "sec-fetch-site": "cross-site" }), 403);
  // A name of somebody else's that leads here is another host, too.
  assert.equal(await ask({ host: `rebound.example:${port}`, origin: `http://rebound.example:${port}` }), 421);
});

await test("a program that has ended is told of", async () => {
  server.removeAllListeners("exit");
  server.kill("SIGINT");
  await state(page, "gone");
  assert.match(await page.textContent("#fault"), /start it again/);
  // There is nobody to save or send anything.
  assert.equal(await page.getAttribute("#save-gcode", "aria-disabled"), "true");
  assert.deepEqual(page.faults, []);
});

await test("the parts of a plate file have parameters of their own", async () => {
  write(good(3));
  const plate = path.join(folder, "plate.toml");
  fs.writeFileSync(plate, `[[part]]
model = "watched.rhai"
copies = 3

[[part]]
model = "watched.rhai"
params = { hollow = true, radius = 6 }
`);
  const [server, address] = await watch(plate);
  const page = await open({ width: 1400, height: 900 }, address);
  try {
    await layers(page, 15);
    const headings = await page.locator("#parameters h3").allTextContents();
    assert.deepEqual(headings, ["1. watched, 3 times", "2. watched"]);
    assert.equal(await page.locator("#parameters .field").count(), 6);
    // What the file says is no change of the page's.
    assert.equal(await page.locator("#parameters .changed").count(), 0);
    await shoot(page, "watch-plate");
    const field = page.locator('[data-name="2.radius"]');
    await field.locator("input").first().fill("9");
    await field.locator("input").first().press("Enter");
    // Another tab shows what became of it.
    await state(page, "busy");
    await state(page, "done");
    const other = await open({ width: 1400, height: 900 }, address);
    const value = key =>
      other.locator(`[data-name="${key}"] input`).first().inputValue();
    assert.deepEqual(
      [await value("1.radius"), await value("2.radius")], ["8", "9"]);
    assert.equal(await other.locator("#parameters .changed").count(), 1);
    await other.close();
    await page.click('[data-view="part"]');
    await page.waitForTimeout(1500);
    await shoot(page, "watch-plate-part");
    // The plate file is watched, and so are its models.
    write(good(5));
    await page.click('[data-view="layers"]');
    await layers(page, 25);
    assert.deepEqual(page.faults, []);
  } finally {
    server.removeAllListeners("exit");
    server.kill("SIGINT");
  }
});

await browser.close();
server.kill("SIGINT");
console.log(`${tests - failures.length} of ${tests} tests of watch passed`);
process.exit(failures.length > 0 ? 1 : 0);
