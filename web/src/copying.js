// The button that copies the pose.

const part = (id) => document.getElementById(id);

/** Copies the matrix with all digits; where the clipboard is closed to pages, by a selection. */
export function copying() {
  const button = part("copy");
  button.hidden = false;
  button.addEventListener("click", async () => {
    const words = part("matrix").textContent;
    let done = true;
    try {
      await navigator.clipboard.writeText(words);
    } catch {
      getSelection().selectAllChildren(part("matrix"));
      done = document.execCommand("copy");
    }
    part("copied").textContent = done ? " copied, all digits" : " press Ctrl+C: it is selected below";
  });
}
