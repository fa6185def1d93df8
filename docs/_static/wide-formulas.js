// A formula in a line that is wider than its paragraph scrolls by itself, so that nothing is cut off.
document.addEventListener("DOMContentLoaded", () => {
  const mark = () => {
    for (const formula of document.querySelectorAll("span.math mjx-container")) {
      const block = formula.closest("p, li, dd, td, div");
      const { width } = formula.querySelector("svg").getBoundingClientRect();
      formula.classList.toggle("wide", width > block.clientWidth);
    }
  };
  window.addEventListener("load", () => window.MathJax?.startup?.promise?.then(mark));
  window.addEventListener("resize", mark);
});
