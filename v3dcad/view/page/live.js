// A served page loads itself again when it was made anew, and keeps what is shown.

const KEY = "v3dcad";

// What was shown before the page was loaded again, or nothing.
export function kept() {
  const text = sessionStorage.getItem(KEY);
  sessionStorage.removeItem(KEY);
  return text ? JSON.parse(text) : {};
}

// `number` is the page's; `shown()` gives what to keep; `tell` shows what went wrong while the page was made anew.
export function follow(number, shown, tell) {
  const changes = new EventSource(`changes?${number}`);
  changes.addEventListener("made", () => {
    sessionStorage.setItem(KEY, JSON.stringify(shown()));
    location.reload();
  });
  changes.addEventListener("failed", (event) => tell(event.data));
}
