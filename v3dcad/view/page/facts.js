// What is told of a cell: its site, volume, area and neighbours.

import { areas, neighbours, sitePlace } from "./cells.js";

const round = (value, digits = 4) => String(Number(value.toPrecision(digits)));

// Facts of a cell as rows of name and text.
export function factsOf(structure, layer, site) {
  const area = areas(structure, layer).get(site);
  const place = sitePlace(structure, layer, site);
  const height = structure.arrays.site_heights[site];
  const at = place && [...place, height].map((value) => round(value)).join(", ");
  return [
    ...(at ? [["site", `${at} mm`]] : []), // the layer knows where those of its own cells are
    ["volume", `${round(structure.arrays.volumes[site])} mm³`],
    ["area on this layer", area === undefined ? "none" : `${round(area)} mm²`],
  ];
}

// Show a cell in `card`, its neighbours as buttons that call `choose`.
export function showCell(card, structure, { cell, layer, target, neighbour }, choose) {
  card.hidden = cell < 0;
  if (card.hidden) return;
  card.querySelector("h2").textContent = `Cell ${cell}`;
  const rows = factsOf(structure, layer, cell).flatMap(([name, text]) => [
    element("dt", name),
    element("dd", text),
  ]);
  card.querySelector("dl").replaceChildren(...rows);
  const beside = neighbours(structure, layer, cell);
  const many = beside.length === 1 ? "One neighbour" : `${beside.length || "No"} neighbours`;
  card.querySelector("h3").textContent = `${many} on this layer`;
  const buttons = beside.map((site) => {
    const button = element("button", String(site));
    button.type = "button";
    button.addEventListener("click", () => choose(site));
    if (target === "neighbour") button.setAttribute("aria-pressed", String(site === neighbour));
    return button;
  });
  card.querySelector(".neighbours").replaceChildren(...buttons);
}

export function element(tag, text) {
  const made = document.createElement(tag);
  made.textContent = text;
  return made;
}
