// What is shown: controls write it, drawing reads it, and nobody else keeps a copy.

export class State {
  #watchers = [];
  #follow;

  // `follow(values, patch)` gives what else changes with a patch.
  constructor(values, follow = () => ({})) {
    this.values = { ...values };
    this.#follow = follow;
  }

  // Change some values; who watches hears of those that are new, once.
  set(patch) {
    const all = { ...patch, ...this.#follow(this.values, patch) };
    const changed = Object.keys(all).filter((name) => this.values[name] !== all[name]);
    if (!changed.length) return;
    Object.assign(this.values, all);
    for (const watcher of this.#watchers) watcher(this.values, new Set(changed));
  }

  // Call `watcher` with all values and the names of those that changed: now, and at every change.
  watch(watcher) {
    this.#watchers.push(watcher);
    watcher(this.values, new Set(Object.keys(this.values)));
  }
}
