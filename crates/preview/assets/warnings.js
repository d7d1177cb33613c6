// What the user should know, listed, and shown where it is in the print.

const PLACE = /\bx = (-?[\d.]+), y = (-?[\d.]+), z = (-?[\d.]+)/;
// "line 12", or "part.gcode:12: …".
const LINE = /\bline (\d+)\b|:(\d+):/;

function listWarnings(texts) {
  const list = $("warnings");
  const items = texts.map(text => {
    const item = document.createElement("li");
    const to = wayTo(text);
    if (to) {
      const button = element("button", text,
        { className: "warning", title: "Show where that is" });
      button.addEventListener("click", to);
      item.append(button);
    } else {
      item.append(element("span", text, { className: "warning" }));
    }
    return item;
  });
  list.replaceChildren(...items);
  list.hidden = items.length === 0;
}

// What shows the place that a warning names, if it names one.
function wayTo(text) {
  const place = text.match(PLACE);
  if (place) {
    return () => told && showPlace(place.slice(1).map(Number));
  }
  const line = text.match(LINE);
  return line && (() => told && showLine(Number(line[1] ?? line[2])));
}

// Places are told in tenths of a millimetre, mm.
const ROUNDED = 0.051;

// The layers up to what begins at a place, with a pointer to it.
function showPlace(place) {
  live?.showLayers();
  toLayer(layerAt(place[2] + ROUNDED));
  state.pointed = place;
  camera.target = [...place];
  redraw(false);
}

// The first move that a line of the file, or one behind it, makes.
function showLine(line) {
  const move = countBelow(moves.lines, line);
  if (move < moves.count) {
    live?.showLayers();
    pick(move);
    goToPicked();
    camera.target = moves.place(move);
    redraw(false);
  }
}
