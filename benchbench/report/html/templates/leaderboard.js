"use strict";
// A cell leads to its plan: what it leads to is opened, also where the address of the page names it.
(() => {
  const show = () => {
    const entry = location.hash && document.getElementById(decodeURIComponent(location.hash.slice(1)));
    if (!(entry instanceof HTMLDetailsElement)) return;
    entry.open = true;
    entry.scrollIntoView();
  };
  addEventListener("hashchange", show);
  for (const link of document.querySelectorAll("#leaderboard a")) link.addEventListener("click", () => setTimeout(show));
  show();
})();
