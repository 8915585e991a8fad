"use strict";
// Sorts and filters the table of runs; a run whose plan is on the page links to it.
(() => {
  const table = document.getElementById("run-table");
  const body = table.tBodies[0];
  const rows = [...body.rows];
  const heads = [...table.querySelectorAll("thead th")];
  const filters = [...table.querySelectorAll(".filters input")];
  const key = (row, column) => row.cells[column].dataset.key;

  const compare = (a, b, numeric) => (numeric ? a - b : a.localeCompare(b, undefined, { numeric: true }));

  const sort = (column) => {
    const head = heads[column];
    const down = head.ariaSort === "ascending";
    const numeric = head.classList.contains("number");
    heads.forEach((other) => other.removeAttribute("aria-sort"));
    head.ariaSort = down ? "descending" : "ascending";
    rows.sort((one, two) => {
      const a = key(one, column), b = key(two, column);
      if (a === "" || b === "") return (a === "") - (b === ""); // empty cells stay at the end
      return (down ? -1 : 1) * compare(a, b, numeric);
    });
    body.append(...rows);
  };

  // "<2", ">=0.5", "=100", "2..3" for numbers, any other text must occur in the cell; "!" turns it round
  const condition = (text, numeric) => {
    const excluded = text.startsWith("!");
    const wanted = (excluded ? text.slice(1) : text).trim().toLowerCase();
    const test = (numeric && numberTest(wanted)) || ((cell) => cell.toLowerCase().includes(wanted));
    return (cell) => test(cell) !== excluded;
  };

  const numberTest = (text) => {
    const number = "([-+]?[0-9]*[.]?[0-9]+(?:e[-+]?[0-9]+)?)";
    const range = text.match(new RegExp(`^${number} *[.][.] *${number}$`));
    const bound = text.match(new RegExp(`^(<=?|>=?|=) *${number}$`));
    const known = (test) => (cell) => cell !== "" && test(Number(cell));
    if (range) return known((value) => Number(range[1]) <= value && value <= Number(range[2]));
    if (!bound) return null;
    const limit = Number(bound[2]);
    return known({
      "<": (value) => value < limit, "<=": (value) => value <= limit, "=": (value) => value === limit,
      ">": (value) => value > limit, ">=": (value) => value >= limit,
    }[bound[1]]);
  };

  const filter = () => {
    const wanted = filters
      .map((input, column) => [input, column])
      .filter(([input]) => input.value.trim() !== "")
      .map(([input, column]) => [condition(input.value.trim(), "numeric" in input.dataset), column]);
    for (const row of rows) row.hidden = !wanted.every(([test, column]) => test(key(row, column)));
    const shown = rows.filter((row) => !row.hidden).length;
    document.getElementById("shown").textContent = `${shown} of ${rows.length} runs shown.`;
  };

  const link = () => {
    const plans = new Map([...document.querySelectorAll("details.plan")].map((plan) => [plan.dataset.run, plan]));
    for (const row of rows) {
      const plan = plans.get(row.cells[0].textContent);
      if (!plan) continue;
      const button = document.createElement("button");
      button.textContent = row.cells[0].textContent;
      button.title = "show the plan";
      button.className = "link";
      button.addEventListener("click", () => {
        plan.open = true;
        plan.scrollIntoView();
      });
      row.cells[0].replaceChildren(button);
    }
  };

  heads.forEach((head, column) => head.firstElementChild.addEventListener("click", () => sort(column)));
  filters.forEach((input) => input.addEventListener("input", filter));
  link();
  filter();
})();
