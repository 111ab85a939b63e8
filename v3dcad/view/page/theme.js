// Dark or light: as the system is, unless the user says otherwise.

const system = matchMedia("(prefers-color-scheme: dark)");
export const THEMES = ["system", "light", "dark"];

// Call `changed` whenever the system turns dark or light.
export function follow(changed) {
  system.addEventListener("change", changed);
}

// Put a theme on the page, and give the colours that the drawing takes from the style sheet.
export function dress(theme) {
  const dark = theme === "dark" || (theme === "system" && system.matches);
  document.documentElement.dataset.theme = dark ? "dark" : "light";
  const style = getComputedStyle(document.documentElement);
  const colour = (name) => style.getPropertyValue(`--${name}`).trim();
  const names = ["background", "skin", "edge", "mark"];
  return Object.fromEntries(names.map((name) => [name, colour(name)]));
}
